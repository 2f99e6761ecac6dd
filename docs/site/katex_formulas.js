// Shows the formulas of a page, once KaTeX is there. SPDX-License-Identifier: BSD-3-Clause
window.addEventListener("load", () =>
  renderMathInElement(document.body, {
    delimiters: [
      { left: "\\(", right: "\\)", display: false },
      { left: "\\[", right: "\\]", display: true },
    ],
  })
);
