"""Draws mutants at random places: a table of operators, each applied to an expression or a statement of one line.

A mutant has the form of those in mutants.json, with "at", its first and last character in the file, instead of "in".
"""
import random
import re

# Name, what it finds, what comes in its place. An operand is a name, a member, an element, or a number.
OPERAND = r"[\w.]+(?:\[\w+\])?(?:->\w+)?"
OPERATORS = [
    ("sign", r" \+ ", " - "), ("sign", r" - ", " + "), ("sign", r"(?<=[(=,] )-(?=[a-z(])|(?<=\()-(?=[a-z(])", ""),
    ("comparison", r" < ", " <= "), ("comparison", r" <= ", " < "), ("comparison", r" > ", " >= "),
    ("comparison", r" >= ", " > "), ("comparison", r" == ", " != "), ("comparison", r" && ", " || "),
    ("comparison", r" and ", " or "), ("index", r"(?<=\w)\[\w+\]", "[0]"), ("index", r" [-+] 1\b(?![.\w])", ""),
    ("unit factor", rf" [*/] {OPERAND}(?=[;,) ]|$)", ""), ("unit factor", r"(?<![\w.])(0\.5|2\.0) \* ", ""),
    ("swapped arguments", rf"(?<=\w)\(({OPERAND}), ({OPERAND})\)", r"(\2, \1)"),
    ("stale value", r"(\w+)_(?:before|previous)\b", r"\1")]
# Statements that a mutant leaves out. A declaration begins with a type, and is none.
STATEMENTS = [("missing reset", r"[a-z][\w.\->\[\]]+(?:\.clear\(\)| = (?:0|0\.0|false|\{\}|nullptr))"),
              ("stale value", r"[a-z][\w.\->\[\]]+ [-+*]?= [^={}][^={}]*")]
EXPRESSIONS = [r"^\s*return (.+);$", r"^\s*(?:const )?(?:double|bool|int|V|auto|std::size_t) \w+ = (.+);$",
               r"^\s*[\w.\->\[\]]+ [-+*]?= (.+);$", r"^\s*(?:\} else )?if \((.+)\) (?:\{|return.*|continue;|break;)$"]
PYTHON = [r"^\s*return (.+)$", r"^\s*[\w.\[\]]+ [-+*]?= (.+)$", r"^\s*(?:el)?if (.+):$"]
NO_EXPRESSION = re.compile(r'(?<![=!<>])=(?!=)|["\'{]|//|#|\[[&=]|\]\(|\bfor\b|Union\[|\blambda\b|\byield\b|\w<\w.*>\(')


def is_whole(text):
    """Whether all brackets close, and no comma stands outside of them."""
    depth = 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if depth < 0 or (letter == "," and depth == 0):
            return False
    return depth == 0


def of_line(line, is_python):
    """(operator, first character, text, the text in its place) of each mutant of a line."""
    for name, pattern in () if is_python else STATEMENTS:
        if found := re.match(rf"\s*({pattern};)$", line):
            yield name, found.start(1), found[1], ";"
    for pattern in PYTHON if is_python else EXPRESSIONS:
        found = re.match(pattern, line)
        if not found or NO_EXPRESSION.search(found[1]) or not is_whole(found[1]):
            continue
        for name, what, instead in OPERATORS:
            for place in re.finditer(what, found[1]):
                after = found[1][:place.start()] + place.expand(instead) + found[1][place.end():]
                if after != found[1] and is_whole(after):
                    yield name, found.start(1), found[1], after


def of_file(file, text):
    begin, quoted = 0, False
    for number, line in enumerate(text.split("\n"), 1):
        quoted ^= line.count('"""') == 1
        for name, first, before, after in () if quoted else of_line(line, file.endswith(".py")):
            yield {"name": f"{file}:{number}: {name}: {before} -> {after}", "file": file, "line": number, "from": before,
                   "to": after, "at": [begin + first, begin + first + len(before)], "tests": []}
        begin += len(line) + 1


def draw(sources, count, seed, of_lines=None):
    """Mutants of an area, one in a line at most; sources: the texts by file; of_lines: the numbers of lines by file."""
    by_operator = {}
    for file in sorted(sources):
        for mutant in of_file(file, sources[file]):
            if of_lines and mutant["line"] not in of_lines[file]:
                continue
            by_operator.setdefault(mutant["name"].split(": ")[1], []).append(mutant)
    chance, drawn, lines = random.Random(seed), [], set()
    while by_operator and len(drawn) < count:
        operator = chance.choice(sorted(by_operator))  # each operator as often as another, however rare its places
        mutant = by_operator[operator].pop(chance.randrange(len(by_operator[operator])))
        if not by_operator[operator]:
            del by_operator[operator]
        if (mutant["file"], mutant["line"]) not in lines:
            lines.add((mutant["file"], mutant["line"]))
            drawn.append(mutant)
    return drawn
