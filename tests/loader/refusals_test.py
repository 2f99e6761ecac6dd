# What the loader says of libraries, of the descriptions beside them, and of names. Each row of refusals.json puts files
# into a new folder, changes the copy of a description, and makes calls, whose messages must be as they stand there:
# empty where the call succeeds; "..." stands for any text, {folder} and {law} for the folder and the library law.so in
# it. A row with "each" stands for several, with the values in place of {each}.
#
#   files   by name: text, or what is made of a variant of this folder's plug-in: "of", then "bytes" written at places
#           (numbers, names of the ELF header, or those of the last segment that is loaded; text is added to the
#           size), "size" to cut to
#   set     members of law.json, by JSON pointer, after ilaw-describe wrote it; null removes one
#   then    files that are written after it
#   path    ILAW_PATH, "{folder}" if left out; null: not set
#   calls   open, named (by a name alone), read (the description), describe (by the program), with a file
import copy
import ctypes
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).parent
PLUGINS, HOSTS, LOADER = (pathlib.Path(os.environ[name]) for name in ("ILAW_TEST_PLUGINS", "ILAW_HOSTS", "ILAW_LOADER"))
HEADER = {"class": (4, "B"), "data": (5, "B"), "type": (16, "H"), "machine": (18, "H"), "phoff": (32, "Q"),
          "shoff": (40, "Q"), "phentsize": (54, "H")}
SEGMENT = {"offset": (8, "Q"), "filesz": (32, "Q"), "memsz": (40, "Q")}

def call_loader(call, name):
    """The message of a call, empty where it succeeds."""
    loader, name = ctypes.CDLL(LOADER), name.encode()
    message, text = ctypes.create_string_buffer(8192), ctypes.create_string_buffer(65536)
    if call == "read":
        size = ctypes.c_size_t()
        code = loader.ilaw_library_read_description(name, text, ctypes.c_size_t(len(text)), ctypes.byref(size), message,
                                                    ctypes.c_size_t(len(message)))
    else:
        opened = loader.ilaw_library_open if call == "open" else loader.ilaw_library_open_named
        code = opened(name, ctypes.byref(ctypes.c_void_p()), message, ctypes.c_size_t(len(message)))
    return message.value if code else b""


def in_child(path, folder, work):
    """What a process of its own writes: some files would end this one."""
    reads, writes = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reads)
        os.chdir(folder)
        os.environ.pop("ILAW_PATH", None)
        if path is not None:
            os.environ["ILAW_PATH"] = path
        os.write(writes, work())
        os._exit(0)
    os.close(writes)
    with os.fdopen(reads, "rb") as pipe:
        said = pipe.read().decode()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return said if code == 0 else f"exit code {code}: {said}"


def last_loaded(data):
    first, count = struct.unpack_from("<Q", data, 32)[0], struct.unpack_from("<H", data, 56)[0]
    return [at for at in (first + 56*k for k in range(count)) if struct.unpack_from("<I", data, at)[0] == 1][-1]


def made(given):
    """The bytes of a file."""
    if isinstance(given, str):
        return given.encode("latin-1")
    data = bytearray((PLUGINS / f"{given['of']}.so").read_bytes())
    load = last_loaded(data)
    for place, value in given.get("bytes", {}).items():
        at, form = HEADER.get(place) or (int(place), "B") if place not in SEGMENT else SEGMENT[place]
        value = len(data) + int(value) if isinstance(value, str) else value
        struct.pack_into(f"<{form}", data, at + (load if place in SEGMENT else 0), value)
    for old, new in given.get("texts", {}).items():
        data[:] = data.replace(old.encode(), new.encode(), 1)
    size = given.get("size", len(data))
    return bytes(data[:size if size >= 0 else len(data) + size])


def fits(text, expected):
    """Whether a text is the expected one, with anything in place of "..."."""
    first, *others = expected.split("...")
    if not others:
        return text == expected
    at = len(first)
    for part in others[:-1]:
        found = text.find(part, at)
        if found < 0:
            return False
        at = found + len(part)
    return text.startswith(first) and text.endswith(others[-1]) and at + len(others[-1]) <= len(text)


def said_by(call, folder, path):
    what, _, name = call.partition(" ")
    name = name.encode().decode("unicode_escape")
    if what == "describe":
        done = subprocess.run([HOSTS / "ilaw-describe", folder / name], capture_output=True, text=True)
        return done.stdout + done.stderr
    if what != "named" and "/" not in name:
        name = str(folder / name)
    return in_child(path, folder, lambda: call_loader(what, name))


def change(description, pointer, value):
    *way, last = [int(part) if part.isdigit() else part for part in pointer.split("/")[1:]]
    for part in way:
        description = description[part]
    if value is None:
        del description[last]
    elif isinstance(description, list) and last == len(description):
        description.append(value)
    else:
        description[last] = value


class Refusals(unittest.TestCase):
    def test_describe_writes_all_that_the_library_says(self):
        with tempfile.TemporaryDirectory() as folder:
            law = pathlib.Path(folder) / "law.so"
            law.write_bytes(made({"of": "good"}))
            self.assertEqual(said_by("describe law.so", pathlib.Path(folder), None), "")
            parameter = {"name": "strength", "symbol": "s", "unit": "1", "doc": "Nothing.", "kind": "number", "minimum": 0,
                         "maximum": "inf", "default": 0.5, "flags": ["allows_infinity", "allows_per_node"], "choices": [],
                         "axes": ["time", "slip_speed"]}
            said = {"id": "zero", "title": "Nothing", "doc": "Gives no impulse.", "references": [], "dimensions": ["1"],
                    "delassus_forms": ["scalar"], "frames": ["local"], "numbers": ["double"], "inputs": ["gap"],
                    "outputs": [], "capabilities": [], "permissions": ["skip_fresh"], "parameters": [parameter],
                    "state_variables": [], "amounts": [{"name": "heat", "unit": "J", "doc": "Of friction."}]}
            self.assertEqual(json.loads(law.with_suffix(".json").read_text()), {
                "format": "ilaw-description/1", "name": "variant", "version": "0.1", "vendor": "tests",
                "licence": "BSD-3-Clause", "abi": [1, 0], "laws": [said]})

    def judge(self, row):
        with tempfile.TemporaryDirectory() as made_folder:
            folder = pathlib.Path(made_folder).resolve()
            folder.chmod(0o755)
            names = {"{folder}": str(folder), "{law}": str(folder / "law.so"), "{json}": str(folder / "law.json")}

            def filled(text):
                for name, value in names.items():
                    text = text.replace(name, value)
                return text

            for name, given in {"law.so": {"of": "good"}, **row.get("files", {})}.items():
                if given is not None:
                    (folder / name).parent.mkdir(exist_ok=True)
                    (folder / name).write_bytes(made(given))
            if "set" in row:
                subprocess.run([HOSTS / "ilaw-describe", folder / "law.so"], check=True)
                description = json.loads((folder / "law.json").read_text())
                for pointer, value in row["set"].items():
                    change(description, pointer, value)
                (folder / "law.json").write_text(json.dumps(description))
            for name, given in row.get("then", {}).items():
                (folder / name).write_bytes(made(given))
            for call, expected in row["calls"].items():
                path = row.get("path", "{folder}")
                said, expected = said_by(call, folder, path and filled(path)), filled(expected)
                self.assertTrue(fits(said, expected), f"{call} says\n  {said!r}\nexpected\n  {expected!r}")

    def test_are_as_in_the_table(self):
        for row in json.loads((HERE / "refusals.json").read_text()):
            for one in row.get("each", [None]):
                given = copy.deepcopy(row)
                given.pop("each", None)
                if one is not None:
                    text = json.dumps(given).replace('"{each}"', json.dumps(one))
                    given = json.loads(text.replace("{each}", json.dumps(one)[1:-1]))
                with self.subTest(row["of"], each=one):
                    self.judge(given)


if __name__ == "__main__":
    unittest.main()
