// The same code in several languages, block after block, becomes tabs. SPDX-License-Identifier: BSD-3-Clause
window.addEventListener("load", () => {
  const names = { c: "C", cpp: "C++", fortran: "Fortran", python: "Python" };
  const language = (block) => Object.keys(names).find((l) => block?.classList.contains(`highlight-${l}`));
  const show = (chosen) => {
    for (const tabs of document.querySelectorAll(".tabs")) {
      const has = tabs.querySelector(`.highlight-${chosen}`);
      if (!has) continue;
      for (const part of tabs.children) {
        if (language(part)) part.style.display = part === has ? "" : "none"; // a theme outweighs hidden
        else for (const button of part.children) button.ariaPressed = button.value === chosen;
      }
    }
  };
  for (const first of document.querySelectorAll("div[class*='highlight-']")) {
    const blocks = [first];
    while (language(blocks.at(-1)?.nextElementSibling)) blocks.push(blocks.at(-1).nextElementSibling);
    const kinds = new Set(blocks.map(language));
    if (first.closest(".tabs") || kinds.has(undefined) || kinds.size < 2 || kinds.size < blocks.length) continue;
    const tabs = document.createElement("div"), buttons = document.createElement("div");
    tabs.className = "tabs";
    first.before(tabs);
    for (const kind of kinds) {
      const button = document.createElement("button");
      [button.textContent, button.value, button.onclick] = [names[kind], kind, () => show(kind)];
      buttons.append(button);
    }
    tabs.append(buttons, ...blocks);
    show([...kinds][0]);
  }
});
