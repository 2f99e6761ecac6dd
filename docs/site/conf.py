"""The site: all pages of the tree as they stand, with the headers as Doxygen reads them (docs/site/build.sh)."""
# SPDX-License-Identifier: BSD-3-Clause

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KATEX = "/usr/share/javascript/katex"  # Debian's libjs-katex: formulas are shown without a network

project = "ilaw"
author = copyright = "the ilaw authors"
version = release = re.search(r"project\(ilaw VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]

# The folder of sources is the tree itself, so that links and pictures of pages need no second form.
extensions = ["myst_parser", "breathe", "sphinx.ext.mathjax"]
root_doc = "README"
include_patterns = [f"{folder}/**.md" for folder in ("api", "docs", "host_mock", "plugins")] + ["README.md"]
exclude_patterns = ["build*", "**/.*", "tests"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

breathe_projects = {"ilaw": str(ROOT / "build" / "site_doxygen" / "xml")}
breathe_default_project = "ilaw"
breathe_domain_by_extension = {"h": "c", "hpp": "cpp"}

html_theme = "furo"
html_title = f"ilaw {version}"
html_static_path = [KATEX, "katex_formulas.js", "language_tabs.js"]
html_css_files = ["katex.min.css"]
html_js_files = [("katex.min.js", {"defer": "defer"}), ("contrib/auto-render.js", {"defer": "defer"}), "language_tabs.js"]
mathjax_path = "katex_formulas.js"
mathjax_options = {"defer": "defer"}
html_copy_source = False


def toctrees(index):
    """The contents of the site: a part for each table of docs/README.md, with the pages that the table links."""
    parts = re.split(r"^\| ([a-z -]+) \| \|$", index, flags=re.M)[1:]
    listed = {"../README"}
    for caption, table in zip(parts[::2], parts[1::2]):
        pages = dict.fromkeys(re.findall(r"\]\(([^)#:]+)\.md[^)]*\)", table))
        pages = [page for page in pages if page not in listed]
        listed.update(pages)
        entries = [page[2:] if page.startswith("../") else f"/docs/{page}" for page in pages]
        yield "\n".join(["", "```{toctree}", ":hidden:", f":caption: {caption}", *entries, "```", ""])


def add_contents(app, page, text):
    if page == root_doc:
        index = ROOT / "docs" / "README.md"
        app.env.note_dependency(str(index))
        text[0] += "\n```{toctree}\n:hidden:\n/docs/README\n```\n" + "".join(toctrees(index.read_text()))


def leave_folder_as_text(_app, env, node, text):
    """A link to a folder of the tree has no page to lead to."""
    if (Path(env.doc2path(node["refdoc"])).parent / node["reftarget"]).is_dir():
        return text
    return None


def setup(app):
    app.connect("source-read", add_contents)
    app.connect("missing-reference", leave_folder_as_text)
