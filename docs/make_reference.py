#!/usr/bin/env python3
"""Writes the reference pages and the manual pages that repeat what the sources say.

    docs/make_reference.py keys                    docs/reference/scene_keys.md, from the schema of scenes
    docs/make_reference.py commands PROGRAM        docs/reference/commands.md, from the --help of ilaw
    docs/make_reference.py man ILAW ILAW-CHECK     docs/man/*.1, from their --help and docs/man/*.1.in, by pandoc
    ... --check                                    writes nothing; exit code 1 where the page is out of date
"""
# SPDX-License-Identifier: BSD-3-Clause

import difflib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ROOT / "docs" / "reference"
MANUALS = ROOT / "docs" / "man"
SCHEMA = ROOT / "host_mock" / "schema" / "scene.schema.json"

# Sections in the order of a scene: heading, then the objects of the schema that it lists.
SECTIONS = [
    ("The scene", [("", "")]),
    ("Time", [("time", "`time`")]),
    ("Points", [("model_points", "`model` of type `points`"), ("point", "entries of `points`"),
                ("thermal_point", "`thermal` of a point")]),
    ("Rotating spring", [("model_rotating_spring", "`model` of type `rotating_spring`")]),
    ("Bars", [("model_bars", "`model` of type `bars`"), ("bar", "entries of `bars`")]),
    ("Blocks", [("model_blocks", "`model` of type `blocks`"), ("block", "entries of `blocks`"),
                ("material", "`material`"), ("thermal", "`thermal`")]),
    ("Solids", [("model_solids", "`model` of type `solids`"), ("mesh", "entries of `meshes`")]),
    ("Nodes", []),
    ("Initial displacements", [("initial", "entries of `initial`")]),
    ("Prestress", [("prestress", "`prestress`")]),
    ("Springs", [("spring", "entries of `springs`")]),
    ("Loads", [("load", "entries of `loads`, common to all types")]),
    ("Gravity", [("load_gravity", "load of type `gravity`")]),
    ("Force", [("load_force", "load of type `force`")]),
    ("Shock", [("load_shock", "load of type `shock`")]),
    ("Pressure", [("load_pressure", "load of type `pressure`")]),
    ("Motion", [("load_motion", "load of type `motion`")]),
    ("Damping", [("load_damping", "load of type `damping`"),
                 ("load_bulk_viscosity", "load of type `bulk_viscosity`")]),
    ("Temperature", [("load_temperature", "load of type `temperature`")]),
    ("Heat flux", [("load_heat_flux", "load of type `heat_flux`")]),
    ("Curves over time", [("history_curve", "a curve, or a path, as an object"), ("sine", "`sine`")]),
    ("Interfaces", [("interface", "entries of `interfaces`"), ("against", "`against`"),
                    ("obstacle", "`obstacle`, common to all types")]),
    ("Plane", [("obstacle_plane", "`obstacle` of type `plane`"), ("tilt", "`tilt` of a plane")]),
    ("Sphere", [("obstacle_sphere", "`obstacle` of type `sphere`")]),
    ("Cylinder", [("obstacle_cylinder", "`obstacle` of type `cylinder`")]),
    ("Output", [("output", "`output`")]),
    ("Expected values", [("expect", "entries of `expect`")]),
    ("Closed forms", [("exact", "`exact`")]),
    ("Convergence", [("converge", "`converge`")]),
    ("Laws side by side", [("study", "`study`"), ("study_law", "entries of `laws`")]),
]
# Objects without a table: NODES, VALUES, the sections of bodies or a curve say their keys.
IN_WORDS = {"near", "box", "units", "force_of", "model", "path_curve"}
# Definitions that are values and not objects of their own: as the tables name them.
VALUES = {
    "vector": "vector", "nodes": "[nodes](#nodes)", "history": "[curve](#curves-over-time)",
    "path": "[path](#curves-over-time)", "places": "vector, or list of vectors",
    "model": "type [points](#points), [rotating_spring](#rotating-spring), [bars](#bars), [blocks](#blocks) or "
             "[solids](#solids)",
    "units": "strings `length`, `mass`, `time`, and optional `temperature`",
    "force_of": "object of a name `of` and a point `about`, for its moment",
    "near": "[`near`](#nodes)", "box": "[`box`](#nodes)", "history_rows": "list of [time, value]",
    "path_rows": "list of [time, displacement...]", "obstacle_temperature": "number, or [curve](#curves-over-time)",
}

KEYS_HEAD = """# Reference: keys of a scene

[Scenes](../scenes.md) shows how to write a scene. An unknown key, a wrong type or a value out of range is
refused before anything runs, with its place, the value found and the values allowed. This page is made from
[the schema](../../host_mock/schema/scene.schema.json) by `docs/make_reference.py keys`.

- Keys in bold are required. Vectors have as many components as the model has dimensions.
- JSON has no infinity: write the string `"inf"` where a parameter of a law may be infinite.
- A curve is a list of [time, value], a path a list of [time, displacement...]: linear between its
  times, which must increase, and constant outside; or [an object](#curves-over-time).
"""

NODES = """| value | nodes |
| --- | --- |
| `"all"`, or the name of a set | bar `b` has the sets `b`, `b.left`, `b.right`; block `b` has `b` and its faces `b.x_min`, `b.x_max`, ... `b.z_max`; `sets` adds more |
| `[0, 3]` | numbers, from 0; nodes of blocks are numbered along x first |
| `{"near": [x, y, z], "of": "b"}` | the node nearest to a place, or to each place of a list; of the set `of` alone, if it is given |
| `{"box": [[low], [high]], "of": "b.z_min"}` | the nodes inside, bounds included; of the set `of` alone, if it is given |
"""

COMMANDS_HEAD = """# Reference: commands of ilaw

The program `ilaw` runs scenes, compares laws and checks libraries. Each command prints its options with
`--help`; this page repeats them and is made by `docs/make_reference.py commands build/release/bin/ilaw`.
The files that commands write are in [outputs](outputs.md).
"""


def number(value):
    return "inf" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def limits(part):
    words = [(sign, part[key]) for key, sign in (("minimum", ">="), ("exclusiveMinimum", ">"),
                                                 ("maximum", "<="), ("exclusiveMaximum", "<"))
             if key in part and abs(part[key]) < 1e6]  # a larger bound only keeps numbers from overflow
    return " and ".join(f"{sign} {number(bound)}" for sign, bound in words)


def count(part):
    least, most = part.get("minItems"), part.get("maxItems")
    return f"{least} " if least is not None and least == most else ""


def section_of(name):
    """The anchor of the section that lists the keys of an object."""
    return next(heading for heading, objects in SECTIONS if name in dict(objects)).lower().replace(" ", "-")


def kind(part, definitions):
    """The type of a value, in words."""
    if "$ref" in part:
        name = part["$ref"].rsplit("/", 1)[1]
        return VALUES.get(name) or f"[object](#{section_of(name)})"
    if "anyOf" in part:
        return ", or ".join(dict.fromkeys(kind(one, definitions) for one in part["anyOf"]))
    if "enum" in part:
        return ", ".join(f"`{choice}`" for choice in part["enum"])
    if part.get("type") == "array":
        items = part.get("items", {})
        of = kind(items, definitions)
        if "anyOf" in items:
            return f"list; each entry: {of}"
        type_, _, bounds = of.partition(" ")
        if type_ in ("number", "integer"):
            return f"list of {count(part)}{type_}s" + (f", each {bounds}" if bounds else "")
        return f"list of {count(part)}" + of.replace("[object]", "[objects]").replace("string", "strings") + ("s" if of == "vector" else "")
    if part.get("type") == "string" and "pattern" in part:
        return "name"
    return " ".join(filter(None, (part.get("type", "value"), limits(part))))


def cell(text):
    return text.replace("|", "\\|")


def of_all_types(group, definitions):
    """Optional keys that most types of a group have with one meaning, such as the motion of an obstacle."""
    types = {name[len(group) + 1:]: {key: value for key, value in part["properties"].items()
                                     if key not in part.get("required", [])}
             for name, part in definitions.items() if name.startswith(group + "_") and "properties" in part}
    found = {}
    for key, value in ((key, value) for keys in types.values() for key, value in keys.items() if key != "type"):
        with_it = [name for name, keys in types.items() if key in keys]
        if len(with_it) > len(types) / 2 and all(types[name][key] == value for name in with_it):
            without = [f"`{name}`" for name in types if name not in with_it]
            note = f" (all but {' and '.join(without)})" if without else ""
            found[key] = {**value, "description": re.sub("(?=; default: |$)", note, value["description"], count=1)}
    return found


def table(part, definitions, name):
    rows = ["| key | type | default | meaning |", "| --- | --- | --- | --- |"]
    required = part.get("required", [])
    group = next((group for group in ("obstacle", "load") if name.startswith(group)), None)
    common = of_all_types(group, definitions) if group else {}
    for key, value in {**part["properties"], **(common if name == group else {})}.items():
        if key == "type" and "enum" not in value:
            continue  # it is in the heading
        if name != group and key in common:
            continue  # it is in the table of all types
        if "description" not in value:
            sys.exit(f"{SCHEMA.name}: key '{key}' has no description")
        meaning, _, default = value["description"].partition("; default: ")
        if "default" in value:
            default = f"`{json.dumps(value['default'])}`"
        shown = f"**`{key}`**" if key in required else f"`{key}`"
        rows.append("| " + " | ".join(cell(text) for text in
                                      (shown, kind(value, definitions), default, meaning)) + " |")
    return "\n".join(rows)


def keys_page():
    schema = json.loads(SCHEMA.read_text())
    definitions = schema["definitions"]
    shown = {name for _, objects in SECTIONS for name, _ in objects}
    left = {name for name, part in definitions.items() if part.get("properties") and name not in shown | IN_WORDS}
    if left:
        sys.exit(f"SECTIONS of {__file__} leaves out {', '.join(sorted(left))}")
    text = [KEYS_HEAD]
    for heading, objects in SECTIONS:
        objects = [(name, words) for name, words in objects if not name or name in definitions]
        if not objects and heading != "Nodes":
            continue
        text.append(f"## {heading}\n")
        if heading == "Nodes":
            text.append(NODES)
        for name, words in objects:
            part = definitions[name] if name else schema
            about = part.get("description", "") if name else ""
            if words:
                text.append((words[0].upper() + words[1:]) + (": " + about if about else ":") + "\n")
            text.append(table(part, definitions, name) + "\n")
    return wrapped("\n".join(text))


def wrapped(text, width=100):
    """Paragraphs in lines of the width; code and formulas stay whole."""
    lines = []
    for paragraph in text.split("\n\n"):
        if paragraph.lstrip().startswith(("|", "#", "```", "- ")):
            lines.append(paragraph.strip("\n"))
            continue
        line, block = "", []
        for word in re.findall(r"(?:`[^`]*`|\$[^$]*\$|[^\s`$])+", paragraph):
            if line and len(line) + 1 + len(word) > width:
                block.append(line)
                line = word
            else:
                line = f"{line} {word}" if line else word
        lines.append("\n".join(block + [line]))
    return "\n\n".join(lines).rstrip() + "\n"


def help_of(program, *command):
    environment = dict(os.environ, COLUMNS="100", LC_ALL="C")
    done = subprocess.run([program, *command, "--help"], capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"{program} {' '.join(command)} --help: {done.stderr}")
    return "\n".join(line.rstrip() for line in done.stdout.strip("\n").splitlines())


def commands_of(main):
    return re.findall(r"^  (\w+) +\S", main[main.index("\nSubcommands:"):], re.M)


def commands_page(program):
    main = help_of(program)
    text = wrapped(COMMANDS_HEAD) + f"\n```text\n{main}\n```\n"
    for command in commands_of(main):
        text += f"\n## ilaw {command}\n\n```text\n{help_of(program, command)}\n```\n"
    return text


def literal(text):
    """Text that Markdown leaves as it is."""
    return re.sub(r"([^\w\s,.;:/=-])|(-(?=-))", r"\\\g<0>", text)


def arguments_of(text):
    """The positionals and options that a help lists, as a list of definitions in Markdown."""
    found = []
    for line in text.splitlines():
        if line.startswith(" " * 30):
            found[-1][1] += " " + line.strip()
        elif entry := re.fullmatch(r"  (\S.*?)(?:  +(.*))?", line):
            found.append([entry[1], entry[2] or ""])
    found = [(names, meaning.strip()) for names, meaning in found if not names.startswith("-h,")]
    items = []
    for names, meaning in found:
        name, _, form = names.partition(" ")
        items.append(f"**{literal(name)}** {literal(form)}".strip() + f"\n:   {literal(meaning)}\n")
    return "\n".join(items)


def command_manual(program, command):
    text = help_of(program, command)
    about, usage, *_ = text.splitlines()
    usage = literal(usage.removeprefix(f"Usage: ilaw {command}").strip())
    return f"## ilaw {command}\n\n**ilaw {command}** {usage}\n\n{literal(about)}.\n\n{arguments_of(text)}"


def manual(name, parts):
    """A manual page: its Markdown with the parts that come from the programs, set by pandoc."""
    text = (MANUALS / f"{name}.1.in").read_text()
    for part, content in parts.items():
        text = text.replace(f"@{part}@", content)
    done = subprocess.run(["pandoc", "--standalone", "--fail-if-warnings", "--from=markdown-smart", "--to=man"],
                          input=text, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{name}.1.in: {done.stderr}")
    # mandoc's lint refuses paragraphs after headings and pandoc's name of a font.
    return re.sub(r"^(\.S[HS] .*)\n\.PP$", r"\1", done.stdout, flags=re.M).replace("\\f[C]", "\\f[CR]")


def manuals(program, checker):
    version = re.search(r"project\(ilaw VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    commands = "\n".join(command_manual(program, command) for command in commands_of(help_of(program)))
    yield "ilaw", {"VERSION": version, "COMMANDS": commands}
    yield "ilaw-check", {"VERSION": version, "OPTIONS": arguments_of(help_of(checker))}
    yield "ilaw-describe", {"VERSION": version}


def generated(arguments):
    """The pages that the arguments ask for, with their texts."""
    if arguments == ["keys"]:
        return {PAGES / "scene_keys.md": keys_page()}
    if arguments[:1] == ["commands"] and len(arguments) == 2:
        return {PAGES / "commands.md": commands_page(arguments[1])}
    if arguments[:1] == ["man"] and len(arguments) == 3:
        return {MANUALS / f"{name}.1": manual(name, parts) for name, parts in manuals(*arguments[1:])}
    sys.exit(__doc__)


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--check"]
    for page, text in generated(arguments).items():
        if "--check" not in sys.argv:
            page.write_text(text)
            continue
        before = page.read_text()
        if before != text:
            print("".join(difflib.unified_diff(before.splitlines(True), text.splitlines(True), str(page), "source")))
            sys.exit(f"{page.name} is out of date: run docs/make_reference.py {' '.join(arguments)}")


if __name__ == "__main__":
    main()
