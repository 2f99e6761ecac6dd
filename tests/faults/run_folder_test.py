# The folder of a run as a state machine: drawn sequences of runs, signals, failing disks, damage and moves.
#
# After each action the folder is judged by what is known without the program: files under their final names have the
# bytes of a run that nothing disturbed, or are the beginning of its rows; a refusal changes nothing and names the file.
# Signals and faults come at the n-th call of the program, so a sequence repeats. A sequence that fails is shortened.
# ILAW_RUN_FOLDER_SEED draws others, ILAW_RUN_FOLDER_SEQUENCES more of them.
import collections
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import typing
import unittest
import zlib

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
from state_machine import Broken, demand, search, shrunk  # noqa: E402

FIXED_SEED = 57
SEED = int(os.environ.get("ILAW_RUN_FOLDER_SEED", FIXED_SEED))
SEQUENCES = int(os.environ.get("ILAW_RUN_FOLDER_SEQUENCES", "60"))
ENDS = {"ball": 0.21, "longer_ball": 0.35, "bars": 1.01, "plain": 0.21, "pressed": 0.5, "mesh": 0.05}
WITHOUT_FIELDS = ["plain", "pressed", "mesh"]  # VTK itself crashes without memory
SIGNALS = ["int", "term", "hup"]
CALLS = ["any", "write", "open", "fsync", "rename", "malloc", "worker"]
MOST_AFTER = 8000  # allocations after a signal: a step, and the files of an end
MEMORY = pathlib.Path("/dev/shm")  # fsync takes most of the time elsewhere


class Run(typing.NamedTuple):
    scene: str
    resumes: bool = False
    fault: tuple = None  # call, n, how; "size" is the most bytes of a file
    meanwhile: str = ""  # while the run is stopped at the fault
    threads: int = 1


class Damage(typing.NamedTuple):
    file: str
    how: str
    place: float


class Move(typing.NamedTuple):
    pass


# ---- what is known of a run without the program ----------------------------------------------------------

def files_in(folder):
    """All but the lock, which a killed run leaves to the next one."""
    files = folder.iterdir() if folder.is_dir() else []
    return {file.name: file.read_bytes() for file in files if file.name != "ilaw.lock"}


def without_times(summary):
    return {key: value for key, value in json.loads(summary).items() if key not in ("seconds", "execution")}


def is_whole_checkpoint(data):
    """CBOR of {"checksum": CRC-32, "content": bytes}, decoded here."""
    def number(at):
        size = {0x18: 1, 0x19: 2, 0x1A: 4, 0x1B: 8}.get(data[at] & 0x1F | (0x18 & data[at]), 0)
        return (int.from_bytes(data[at + 1:at + 1 + size], "big") if size else data[at] & 0x1F), at + 1 + size
    if data[:10] != b"\xa2\x68checksum":
        return False
    checksum, at = number(10)
    if data[at:at + 8] != b"\x67content":
        return False
    length, at = number(at + 8)
    return at + length == len(data) and zlib.crc32(data[at:]) == checksum


def column_of_hexahedra(count):
    """A file of VTK. The last element, which sets the critical step, is looked at by the last thread."""
    def array(kind, values, more=""):
        return f'<DataArray type="{kind}" {more} format="ascii">{" ".join(map(str, values))}</DataArray>'
    points = [number for k in range(count + 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)) for number in (x, y, 1 - 0.995**k)]
    cells = (array("Int64", [4 * k + c for k in range(count) for c in range(8)], 'Name="connectivity"')
             + array("Int64", range(8, 8 * count + 1, 8), 'Name="offsets"') + array("UInt8", [12] * count, 'Name="types"'))
    return (f'<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="{4 * count + 4}" '
            f'NumberOfCells="{count}"><Points>' + array("Float64", points, 'NumberOfComponents="3"')
            + f"</Points><Cells>{cells}</Cells></Piece></UnstructuredGrid></VTKFile>")


class World:
    """Scenes, and what an undisturbed run of each leaves."""

    def __init__(self, home):
        self.home, self.files, self.calls = home, {}, {}
        for name, end in ENDS.items():
            scene = json.loads((SOURCE / ("host_mock/scenes/two_bars.json" if name in ("bars", "pressed") else
                                          "plugins/contact/bouncing_ball.json")).read_text())
            scene.pop("expect", None)  # of its own end
            scene["time"]["end"] = end
            scene["output"].update({"every": 1, "fields": 70, "balance": True, "events": True})
            if name == "plain":  # another cause, and fewer files
                scene["loads"][0]["acceleration"] = [-9.0]
                scene["output"] = {"every": 1}
            if name == "pressed":  # far longer than the run
                scene["springs"] = [{"nodes": f"{side}.{side}", "stiffness": 1.0, "anchor": [at]}
                                    for side, at in (("left", -1.0), ("right", 2.0))]
                scene["model"]["bars"][0].update({"start": -1.0, "velocity": 0.0})
                scene.update({"loads": [{"type": "gravity", "acceleration": [-0.01]}], "prestress": {"tolerance": 1e-10},
                              "output": {"every": 1, "events": True}})
            if name == "mesh":  # threads share its elements
                (home / "column.vtu").write_text(column_of_hexahedra(300))
                material = {"type": "linear", "young": 1.0, "poisson": 0.3, "density": 1.0}
                scene.update({"model": {"type": "solids", "meshes": [{"file": "column.vtu", "material": material}]},
                              "time": {"cfl": 0.5, "end": end}, "loads": [{"type": "gravity", "acceleration": [0, 0, -1]}],
                              "output": {"every": 1}})
                scene["interfaces"] = [{"law": "contact", "nodes": "mesh0.z_min",
                                        "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]
            (home / f"{name}.json").write_text(json.dumps(scene))
            for call in CALLS:
                done = self.run(Run(name, fault=(call, 0, "fail"), threads=1 + (call == "worker")), home / name).wait()
                demand(done == 0, self.text())
                self.calls[name, call] = self.count()
            self.files[name] = files_in(home / name)

    def run(self, action, folder):
        call, n, how = action.fault or ("any", 0, "fail")
        command = [os.environ["ILAW_PROGRAM"], "run", self.home / f"{action.scene}.json", "--out", folder,
                   "--checkpoint-every", "40", "--threads", str(action.threads)] + ["--resume"] * action.resumes
        (self.home / "count").unlink(missing_ok=True)
        limit = [n if call == "size" else resource.RLIM_INFINITY] * 2

        def prepare():
            resource.setrlimit(resource.RLIMIT_FSIZE, limit)
            for number in (signal.SIGINT, signal.SIGHUP):  # which a job in the background ignores
                signal.signal(number, signal.SIG_DFL)
        with (self.home / "said").open("w") as said:
            return subprocess.Popen(command, stdout=said, stderr=said, preexec_fn=prepare, env={
                **os.environ, "LD_PRELOAD": os.environ["ILAW_INJECT_LIBRARY"],
                "ILAW_INJECT": f"{folder}:{call}:{n}:{how}", "ILAW_INJECT_COUNT": str(self.home / "count")})

    def text(self):
        return (self.home / "said").read_text()

    def count(self):
        return int((self.home / "count").read_text())


# ---- the folder, action by action ------------------------------------------------------------------------

class Folder:
    def __init__(self, world, seen):
        self.world, self.seen = world, seen
        self.place = pathlib.Path(tempfile.mkdtemp(dir=world.home)) / "a"
        self.is_covered = False  # whether the checkpoint is of the end of all files
        self.owners = set()  # scenes whose files may be in the folder
        self.damaged = {}  # file: whether the checkpoint speaks of all of it

    def do(self, action):
        getattr(self, type(action).__name__.lower())(action)
        self.expect_whole()

    def move(self, _action=None):
        there = self.place.with_name("b" if self.place.name == "a" else "a")
        if self.place.is_dir():
            self.place.rename(there)
        self.place = there

    def damage(self, action):
        file = self.place / action.file
        if not file.is_file() or file.stat().st_size == 0:
            return
        data = bytearray(file.read_bytes())
        at = int(action.place * len(data))
        data[at] ^= 1
        if action.how == "remove":
            file.unlink()
        else:
            file.write_bytes(data[:at] if action.how == "cut" else data)
        # Rows after the last checkpoint are written anew, so their damage does no harm.
        self.damaged[action.file] = action.file == "checkpoint.cbor" or self.is_covered
        self.seen[f"damage: {action.how}"] += 1

    def run(self, action):
        before, place = files_in(self.place), self.place
        program = self.world.run(action, self.place)
        if action.fault and action.fault[2] == "stop":
            self.while_stopped(action, program)
        code, said = program.wait(), self.world.text()
        how = action.fault[2] if self.has_fired(action, code) else ""
        of_memory = f" {action.fault[0]}" if how and action.fault[0] in CALLS[-2:] else ""
        self.seen[f"{'resume' if action.resumes else 'run'} {how or 'undisturbed'}{of_memory}: {code}"] += 1
        self.is_covered = code == 0 or how in SIGNALS or (code == 2 and not how and self.is_covered)
        if code == -signal.SIGKILL and how in ("kill", "stop"):
            self.owners.add(action.scene)
        elif how == "fail" and of_memory and code != 0:
            # Destructors of libraries allocate, too, and end the program.
            demand(code in (1, 2, -signal.SIGABRT), "without memory it gives", code, said)
            demand(("out of memory" in said or "bad_alloc" in said) and "crashed" not in said, said)
            self.owners.add(action.scene)
        elif (how in ("fail", "full") and not of_memory) or (how == "stop" and action.meanwhile == "move"):
            demand(code in (1, 2), "a failure of the disk gives", code, said)
            demand(f"{place}/" in said and "vtk" not in said, "no file is named:", said)
            self.owners.add(action.scene)
            if action.fault[0] == "size":
                self.expect_rows_kept(said)
        elif code == 0:
            demand(not action.resumes or not any(self.damaged.values()), "resumed in spite of damage:", self.damaged)
            self.expect_bits(action.scene, said)
        elif how in SIGNALS and code == 1:
            self.expect_interrupted(action, said)
        else:
            self.expect_refused(action, code, said, before)
        self.forget_damage(before)

    def has_fired(self, action, code):
        if not action.fault or code < 0:  # a killed program counts nothing
            return bool(action.fault)
        return code == 1 if action.fault[0] == "size" else self.world.count() >= action.fault[1]

    def forget_damage(self, before):
        """A new checkpoint speaks of other bytes, and files written anew are sound."""
        after = files_in(self.place)
        is_new = after.get("checkpoint.cbor") != before.get("checkpoint.cbor")
        self.damaged = {file: matters and not is_new for file, matters in self.damaged.items()
                        if after.get(file) == before.get(file)}

    def while_stopped(self, action, program):
        _, status = os.waitpid(program.pid, os.WUNTRACED)
        if not os.WIFSTOPPED(status):
            program.returncode = os.waitstatus_to_exitcode(status)
            return
        said = self.world.text()
        if action.meanwhile == "move":
            self.move()
        else:
            before = files_in(self.place)
            command = [os.environ["ILAW_PROGRAM"], "run", self.world.home / "bars.json", "--out", self.place]
            other = subprocess.run(command, capture_output=True, text=True)
            demand(other.returncode == 2 and f"{self.place}: in use by process {program.pid}" in other.stderr,
                   "a second run in the folder:", other.returncode, other.stderr)
            demand(files_in(self.place) == before, "a second run changed the folder")
        demand(said == self.world.text(), "a stopped program speaks")
        program.send_signal(signal.SIGKILL if action.meanwhile == "second, kill" else signal.SIGCONT)

    # ---- verdicts

    def expect_bits(self, scene, said):
        found, wanted = files_in(self.place), self.world.files[scene]
        demand(sorted(found) == sorted(wanted), "found", sorted(found), "expected", sorted(wanted))
        for name, data in wanted.items():
            same = without_times(found[name]) == without_times(data) if name == "summary.json" else found[name] == data
            demand(same, name, "is not as in an undisturbed run")
        demand(f", state {json.loads(wanted['summary.json'])['state_hash']}" in said, "another state:", said)
        self.owners, self.damaged = {scene}, {}

    def expect_interrupted(self, action, said):
        demand("interrupted at step" in said and str(self.place) in said, said)
        demand("warning" not in said, said)
        if action.fault[0] == "malloc":
            late = self.world.count() - action.fault[1]
            demand(late < MOST_AFTER, "a signal is not heard during", late, "allocations")
        summary, rows = json.loads((self.place / "summary.json").read_text()), (self.place / "history.csv").read_bytes()
        demand(summary["interrupted"], "the summary tells nothing")
        demand(rows.count(b"\n") == 1 + summary["steps"], "other rows than steps")
        demand(not list(self.place.glob("*.partial")), "a stopped run left", list(self.place.glob("*.partial")))
        self.owners.add(action.scene)
        has_checkpoint = (self.place / "checkpoint.cbor").is_file()
        demand(has_checkpoint or not summary["steps"], "a stopped run left no checkpoint")
        demand(("--resume" in said) == has_checkpoint, "with a checkpoint:", has_checkpoint, said)

    def expect_rows_kept(self, said):
        """No file is as large as it must be, but there is room to say so."""
        demand("File too large" in said, said)
        demand(json.loads((self.place / "summary.json").read_text())["failure"], "the summary tells no failure")
        demand((self.place / "history.csv").is_file(), "no rows were kept")
        demand(not (self.place / "history.csv.partial").exists(), "rows are left under another name")

    def expect_refused(self, action, code, said, before):
        demand(code == 2, "exit code", code, said)
        demand(action.resumes, "a new run is refused:", said)
        demand(files_in(self.place) == before, "a refusal changed the folder")
        demand(f"{self.place}/" in said, "no file is named:", said)
        if "checkpoint.cbor" not in before:
            demand("checkpoint.cbor: found no checkpoint" in said, said)
            return
        harmed = [file for file in self.damaged if f"{self.place}/{file}: " in said]
        of_another = self.owners != {action.scene} and f"{self.place}/checkpoint.cbor: is " in said
        demand(harmed or of_another, "refused without a cause:", said)

    def expect_whole(self):
        found = files_in(self.place)
        for name, data in found.items():
            if name.endswith(".partial") or name in self.damaged:
                continue
            wanted = [self.world.files[owner][name] for owner in self.owners if name in self.world.files[owner]]
            demand(wanted, name, "is no file of a run")
            if name == "checkpoint.cbor":
                good = is_whole_checkpoint(data)
            elif name.endswith(".csv"):
                good = data.endswith(b"\n") and any(whole.startswith(data) for whole in wanted)
            elif name.endswith(".vtu"):
                good = data in wanted
            else:
                good = isinstance(json.loads(data), dict)
            demand(good, name, "is not whole")
        if "fields.vtu.series" in found:
            listed = [field["name"] for field in json.loads(found["fields.vtu.series"])["files"]]
            demand(all(name in found or name in self.damaged for name in listed), "the series lists what is not there")


# ---- sequences -------------------------------------------------------------------------------------------

def drawn_run(draw, world, scene, resumes):
    how = draw.choices(["", "fail", "full", "size", "kill", "stop", *SIGNALS], [4, 2, 1, 1, 4, 3, 1, 1, 1])[0]
    if not how:
        return Run(scene, resumes, threads=draw.choice([1, 2]))
    if how == "size":
        return Run(scene, resumes, ("size", draw.randint(8000, 40000), "full"))
    memory = ["malloc"] if how in SIGNALS or how == "kill" or (how == "fail" and scene in WITHOUT_FIELDS) else []
    memory += ["worker"] if how == "fail" and scene == "mesh" else []
    call = "write" if how == "full" else draw.choice((CALLS[:-2] + 2 * memory if how == "fail" else ["any"] + memory))
    first = 2 if how == "stop" else 1  # the first call opens the lock, so before it the folder is free
    fault = (call, draw.randint(first, max(first, world.calls[scene, call] // draw.choice([1, 2, 4, 8]))), how)
    meanwhile = draw.choice(["second", "second, kill", "move"]) if how == "stop" else ""
    return Run(scene, resumes, fault, meanwhile, 1 + (call == "worker"))


def drawn_damage(draw):
    file = draw.choice(["checkpoint.cbor", "history.csv", "events.csv", "fields_000000.vtu", "fields_000003.vtu"])
    return Damage(file, draw.choice(["cut", "turn", "remove"]), draw.random())


def drawn_sequence(draw, world):
    """Runs of mostly one scene, for another one is refused."""
    scene = draw.choice(list(ENDS))
    actions = [drawn_run(draw, world, scene, False)]
    for _ in range(draw.randint(2, 8)):
        kind = draw.choices(["run", "damage", "move"], [8, 2, 1])[0]
        scene = scene if draw.random() < 0.9 else draw.choice(list(ENDS))
        actions.append(drawn_run(draw, world, scene, draw.random() < 0.7) if kind == "run" else
                       drawn_damage(draw) if kind == "damage" else Move())
    return actions


def failure_of(actions, world, seen):
    folder = Folder(world, seen)
    try:
        for action in actions:
            folder.do(action)
    except Broken as broken:
        return str(broken)
    finally:
        shutil.rmtree(folder.place.parent)
    return ""


def plainer(action):
    if isinstance(action, Run):
        for fewer in ({"fault": None, "meanwhile": ""}, {"threads": 1}, {"scene": "ball"}):
            yield action._replace(**fewer)


class RunFolder(unittest.TestCase):
    def setUp(self):
        self.home = pathlib.Path(tempfile.mkdtemp(dir=MEMORY if MEMORY.is_dir() else None))
        self.addCleanup(shutil.rmtree, self.home)

    def test_keeps_its_promises_whatever_happens(self):
        world, seen = World(self.home), collections.Counter()
        actions, why = search(SEED, SEQUENCES, lambda draw: drawn_sequence(draw, world),
                              lambda drawn: failure_of(drawn, world, seen), plainer)
        self.assertFalse(actions, f"seed {SEED}: {why}\n" + "\n".join(map(str, actions)))
        print(f"seed {SEED}, {SEQUENCES} sequences:", dict(sorted(seen.items())))
        if SEED != FIXED_SEED:
            return
        for event in ("run kill: -9", "resume kill: -9", "run full: 1", "run fail: 1", "run int: 1", "run term: 1",
                      "run hup: 1", "run fail malloc: 1", "run fail worker: 1", "run int malloc: 1",
                      "run stop: 1", "run stop: 0", "resume undisturbed: 0", "resume undisturbed: 2", "damage: turn"):
            self.assertGreater(seen[event], 0, event)

    def test_shortens_a_sequence_that_fails(self):
        kill = Run("bars", fault=("any", 9, "kill"), threads=2)
        actions = [Move(), Run("bars"), kill, Damage("history.csv", "cut", 0.5), Move(), Run("bars", True), Move()]

        def fails(fewer):
            killed = [k for k, action in enumerate(fewer) if isinstance(action, Run) and action.fault]
            return any(isinstance(action, Run) and action.resumes for k in killed for action in fewer[k:])
        self.assertEqual(shrunk(actions, fails, plainer), [Run("ball", fault=("any", 9, "kill")), Run("ball", True)])


if __name__ == "__main__":
    unittest.main()
