#!/usr/bin/env python3
"""Prints a header with its plain comments marked for Doxygen (its INPUT_FILTER)."""
# SPDX-License-Identifier: BSD-3-Clause

import re
import sys
from pathlib import Path

STRING = r'"(?:[^"\\\n]|\\.)*"'
COMMENT = re.compile(STRING + r"|/\*(.*?)\*/|//([^\n]*(?:\n[ \t]*//[^\n]*)*)", re.S)


def text_of(match):
    if match[1] is not None:
        return re.sub(r"\n[ \t]*\*?", "\n", match[1])
    return re.sub(r"\n[ \t]*//", "\n", match[2])


def marked(match):
    if match[0].startswith('"'):
        return match[0]
    text = re.sub(r"\s*SPDX-License-Identifier: .*", "", text_of(match))
    if text.lstrip().startswith(("----", "clang-format", "NOLINT")):
        return ""
    # Tables and formulas are indented: they keep their lines.
    if re.search(r"^   ", text, flags=re.M):
        text = f"\\verbatim\n{text.strip(chr(10))}\n\\endverbatim"
    else:
        text = re.sub(r"([\\@&$#<>%\"])", r"\\\1", text).strip()
    # The first comment is that of the file; a comment behind code is that of the code.
    behind_code = match.string[: match.start()].rpartition("\n")[2].strip() != ""
    return f"/**{'<' if behind_code else ''} " + ("\\file\n" if match.start() == 0 else "") + f"{text} */"


sys.stdout.write(COMMENT.sub(marked, Path(sys.argv[1]).read_text()))
