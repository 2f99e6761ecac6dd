# SPDX-License-Identifier: BSD-3-Clause
"""fix ilaw/pair and fix ilaw/wall in the system's lmp, on one to four ranks: closed forms, runs that go on, restarts.
One grain that does not turn: tests/hosts/protocols. Spheres that turn: tests/hosts/spheres.py."""
import math
import os
import pathlib
import re
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import spheres  # noqa: E402

STYLES = os.environ["ILAW_LAMMPS"]
EXAMPLES = sorted((pathlib.Path(os.environ["ILAW_SOURCE"]) / "api" / "lammps" / "examples").glob("in.*"))

BEGIN = f"""
include {STYLES}
units si
atom_style sphere
newton off
atom_modify map array
boundary f f f
pair_style zero 1.2
neighbor 0.3 bin
timestep 1e-3
"""
BOX = "region box block 0 3.2 0 3.2 0 6\ncreate_box 1 box\n"
MASS = "set type 1 diameter 1.0 density 1.909859317102744\n"  # 1
INTEGRATE = "pair_coeff * *\nfix nve all nve/sphere\nfix g all gravity 10 vector 0 0 -1\n"
WALLS = ("fix w all ilaw/wall coulomb friction 0.3 plane 0 0 0 0 0 1 plane 0 0 0 1 0 0 plane 3.2 0 0 -1 0 0 "
         "plane 0 0 0 0 1 0 plane 0 3.2 0 0 -1 0\n")


def some(*values):
    """All of them by .ci/night, else one between the extremes."""
    return list(values) if "ILAW_TEST_WHOLE" in os.environ else [values[len(values) // 2]]


def grains(spacing, skew=0.02):
    """27 on a lattice, a little off their places."""
    return "".join(f"create_atoms 1 single {0.52 + spacing * i + skew * k} {0.52 + spacing * j + skew * i} "
                   f"{0.55 + spacing * k + skew * j}\n" for k in range(3) for j in range(3) for i in range(3))


def pile(law="coulomb friction 0.3", sweeps="sweeps 30 tol 1e-10"):
    return BEGIN + BOX + grains(1.05) + MASS + INTEGRATE + WALLS + f"fix p all ilaw/pair {law} {sweeps}\n"


def state(name):
    """A command that writes all that moves, to the last bit."""
    return f"write_dump all custom {name} {COLUMNS} modify sort id format float %.17g\n"


COLUMNS = "id x y z vx vy vz omegax omegay omegaz"


ENVIRONMENT = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_mpi_yield_when_idle="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                   OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def command(tmp_path, text):
    script = tmp_path / f"in.{len(list(tmp_path.iterdir()))}"
    script.write_text(text)
    return ["lmp", "-in", script.name, "-log", "none", "-nocite"]


def lammps(tmp_path, text, ranks=1):
    """The output of a script; raises with it where LAMMPS refuses."""
    launcher = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    done = subprocess.run(launcher + command(tmp_path, text), cwd=tmp_path, env=ENVIRONMENT, text=True, timeout=300,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0 or "ERROR" in done.stdout:
        raise RuntimeError(done.stdout[-2000:])
    return done.stdout


def read(tmp_path, name):
    """Rows of a dump: atoms by tag."""
    frame = (tmp_path / name).read_text().rsplit("omegaz", 1)[1]
    return [[float(number) for number in line.split()] for line in frame.strip().splitlines()]


def difference(a, b):
    assert len(a) == len(b)
    return max(abs(x - y) for left, right in zip(a, b) for x, y in zip(left, right))


def thermo(output):
    """Numbers of the rows between the header of the thermo output and the time of the loop."""
    rows = re.findall(r"^Step .*\n((?: *[-\d].*\n)+)", output, re.M)
    return [[float(number) for number in line.split()] for line in "".join(rows).splitlines()]


def test_a_pile_settles_and_its_outputs_say_so(tmp_path):
    text = pile() + ("thermo_style custom step ke f_p[1] f_p[3] f_p[4] f_p[5] f_p[6] f_w[1] f_w[4]\n"
                     "thermo 600\nrun 600\n")
    last = thermo(lammps(tmp_path, text))[-1]
    _, kinetic, contacts, residual, overlap, approach, friction, at_walls, wall_overlap = last
    assert kinetic < 0.05 * 27 * 10
    assert contacts > 10 and at_walls >= 9
    assert residual < 1e-3
    assert max(overlap, wall_overlap) < 1e-2
    assert approach < 1e-2
    assert friction > 0


# The walls of this pile say nothing of sweeps and tol: their defaults must not stand for what the pairs ask for.
def test_sweeps_and_tol_of_one_fix_hold_for_all(tmp_path):
    output = "thermo_style custom step f_p[2] f_w[2] f_p[3]\nthermo 300\nrun 600\n"
    _, sweeps, of_walls, residual = thermo(lammps(tmp_path, pile(sweeps="sweeps 50 tol 1e-2") + output))[-1]
    assert sweeps == of_walls < 50 and 1e-8 < residual <= 1e-2
    assert thermo(lammps(tmp_path, pile(sweeps="sweeps 3 tol 1e-12") + output))[-1][1] == 3


def test_ten_runs_are_one_run(tmp_path):
    lammps(tmp_path, pile() + "run 300\n" + state("one"))
    lammps(tmp_path, pile() + "run 30\n" * 10 + state("ten"))
    one = read(tmp_path, "one")
    assert max(abs(row[6]) for row in one) > 1e-3, "nothing happened"
    assert difference(one, read(tmp_path, "ten")) < 1e-12


# In the step in which the grain touches, runs end before and after it.
def test_a_bounce_on_the_border_of_two_runs_is_not_lost(tmp_path):
    begin = (BEGIN + BOX + "create_atoms 1 single 2 2 0.501\nvelocity all set 0 0 -1\n" + MASS
             + "pair_coeff * *\nfix nve all nve/sphere\n"
             + "fix w all ilaw/wall contact restitution 1 plane 0 0 0 0 0 1\n")
    for steps in (1, 2, 3):
        lammps(tmp_path, begin + f"run {steps}\nrun {6 - steps}\n" + state("bounced"))
        assert read(tmp_path, "bounced")[0][6] == pytest.approx(1.0, abs=1e-14), steps


# Two grains hit each other off centre, are bonded by that, and turn: the bond carries what else they would fly
# apart with, on both sides of the border of ranks, across which they go.
PAIR = (BEGIN + "processors * 1 1\nregion box block 0 6 0 4 0 4\ncreate_box 1 box\n"
        + "create_atoms 1 single 1 2 2\ncreate_atoms 1 single 2.1 2.4 2\n" + MASS
        + "group left id 1\nvelocity left set 8 0 0\ngroup right id 2\nvelocity right set 4 0 0\n")
FLIGHT = "pair_coeff * *\nfix nve all nve/sphere\nfix p all ilaw/pair postit memory 0.01 friction 0.3\n"


def assert_bonded(atoms):
    a, b = (row[1:4] for row in atoms)
    assert a[0] > 3 and b[0] > 3
    assert sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5 == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_bond_goes_with_its_grains_to_another_rank(tmp_path, ranks):
    lammps(tmp_path, PAIR + FLIGHT + "run 500\n" + state("bonded"), ranks)
    assert_bonded(read(tmp_path, "bonded"))


RESISTING = "coulomb friction 0.3", "rolling friction 0.3 rolling_friction 0.02 twisting_friction 0.01"
# Two sweeps of a step do not find the moments anew.
RESISTING_PAIRS = f"fix p all ilaw/pair {RESISTING[1]} sweeps 2\n"
SPUN = ("variable s atom 20*sin(id)\nvariable c atom 20*cos(2*id)\nset group all omega v_s v_c v_s\n"
        "velocity all set 0 0 -1\n")


def restarted(step=100):
    return BEGIN.replace("atom_style sphere\n", "").replace("boundary f f f\n", "").replace(
        "newton off\natom_modify map array", f"newton off\nread_restart half.{step}")


@pytest.mark.parametrize("begin, fixes, steps", [
    (BEGIN + BOX + grains(1.05) + MASS, INTEGRATE + WALLS + "fix p all ilaw/pair coulomb friction 0.3\n", 200),
    (BEGIN + BOX + grains(1.05) + MASS + SPUN, INTEGRATE + WALLS.replace(*RESISTING) + RESISTING_PAIRS, 200),
    (PAIR, FLIGHT, 500)], ids=["pile", "moments", "bond"])
def test_a_restart_goes_on_as_if_nothing_had_been(tmp_path, begin, fixes, steps):
    lammps(tmp_path, begin + fixes + f"restart 100 half\nrun {steps}\n" + state("on"))
    lammps(tmp_path, restarted() + fixes + f"run {steps - 100}\n" + state("again"))
    assert difference(read(tmp_path, "on"), read(tmp_path, "again")) < 1e-12
    if steps == 500:
        assert_bonded(read(tmp_path, "again"))


def test_a_restart_does_not_give_moments_to_a_law_without(tmp_path):
    begin, pairs = BEGIN + BOX + grains(1.05) + MASS + INTEGRATE, "fix p all ilaw/pair {}\n"
    lammps(tmp_path, begin + pairs.format(RESISTING[1]) + "restart 100 half\nrun 100\n")
    with pytest.raises(RuntimeError, match="states of another law, version or memory"):
        lammps(tmp_path, restarted() + INTEGRATE + pairs.format(RESISTING[0]) + "run 1\n")


def test_tied_grains_move_as_one(tmp_path):
    text = (BEGIN + BOX + grains(1.0, 0.0) + MASS + "pair_coeff * *\nfix nve all nve/sphere\n"
            + "velocity all create 1e22 4711 dist gaussian\n"
            + "fix p all ilaw/pair tie sweeps 200 tol 1e-12\nthermo_style custom step ke f_p[3]\nthermo 5\nrun 20\n")
    rows = thermo(lammps(tmp_path, text))
    # A tie does no positive work, so their energy falls once, to that of a rigid body, and stays.
    assert rows[1][1] < 0.1 * rows[0][1]
    for before, after in zip(rows[1:], rows[2:]):
        assert after[1] == pytest.approx(before[1], rel=1e-4), "grains move apart, or ties explode"


def test_ranks_agree_on_moments_to_the_tolerance(tmp_path):
    for ranks in (1, 2, 4):
        processors = f"processors {min(ranks, 2)} * 1\n"
        lammps(tmp_path, processors + pile(sweeps="sweeps 2000 tol 1e-12").replace(*RESISTING) + SPUN
               + "run 150\n" + state(f"on{ranks}"), ranks)
    alone = read(tmp_path, "on1")
    assert max(abs(row[7]) for row in alone) > 1, "nothing spins"
    for ranks in (2, 4):
        assert difference(alone, read(tmp_path, f"on{ranks}")) < 1e-7


# A step begins with the moments of the last: 7 iterations, and 19 without.
def test_a_pile_at_rest_needs_few_iterations(tmp_path):
    text = pile(sweeps="sweeps 2000 tol 1e-8").replace(*RESISTING)
    rows = thermo(lammps(tmp_path, text + "thermo_style custom step f_p[1] f_p[2]\nthermo 600\nrun 600\n"))
    assert rows[-1][1] > 10 and rows[-1][2] < 12


# Grains collide and fly apart: without other forces what they lose is what friction, rolling and twisting take.
@pytest.mark.parametrize("dt", some("1e-3", "7.3e-4", "3.1e-4"))
def test_moments_dissipate_what_the_grains_lose(tmp_path, dt):
    steps = round(3 / float(dt))
    text = (BEGIN.replace("timestep 1e-3", f"timestep {dt}")
            + "region box block -20 20 -20 20 -20 20\ncreate_box 1 box\n" + grains(1.2) + MASS + "pair_coeff * *\nfix nve all nve/sphere\n"
            + "variable inward atom 1.7-x\nvelocity all set v_inward 1 0.5\n"
            + "variable spin atom 5*sin(id)\nset group all omega v_spin v_spin v_inward\n"
            + "compute spins all erotate/sphere\ncompute flight all ke\nvariable energy equal c_flight+c_spins\n"
            + f"fix p all ilaw/pair {RESISTING[1]} restitution 0.5 sweeps 2000 tol 1e-12\n"
            + "thermo_style custom step v_energy f_p[1] f_p[6] f_p[7]\n"
            + f"thermo_modify format float %.15g\nthermo {steps}\nrun {steps}\n")
    first, last = thermo(lammps(tmp_path, text))
    assert last[2] == 0, "they still touch"
    assert last[3] > 0.1 and last[1] + last[3] + last[4] == pytest.approx(first[1], rel=1e-9)


def floor_of(case):
    return "" if not case.floor else "plane 0 0 0 0 0 1" + (f" spin 0 0 {case.spin}" if case.spin else "")


def roll(tmp_path, case, wall, dt, ranks=1):
    """x, v and w of the spheres of a case at each of its ends, and the energy that they lost."""
    law = " ".join([case.law, *(f"{name} {value}" for name, value in case.parameters.items())])
    text = (BEGIN.replace("1.2", "0.12").replace("neighbor 0.3", "neighbor 0.03").replace("timestep 1e-3", f"timestep {dt}")
            + f"processors {min(ranks, 2)} * 1\nregion box block -1 3 -1 1 -0.2 0.3 units box\ncreate_box 1 box\n"
            + f"set type 1 diameter {2 * spheres.RADIUS} "
            + f"density {spheres.MASS / (4 / 3 * math.pi * spheres.RADIUS**3)!r}\n")
    made, moves = "", ""
    for k, one in enumerate(case.spheres, 1):
        x, v, w, force = (" ".join(repr(float(number)) for number in vector) for vector in one)
        made += f"create_atoms 1 single {x} units box\n"
        moves += (f"group ball{k} id {k}\nvelocity ball{k} set {v}\nset atom {k} omega {w}\n"
                  f"fix force{k} ball{k} addforce {force}\n")
    before, behind = text.split("set type", 1)
    text = before + made + "set type" + behind + moves + "pair_coeff * *\nfix nve all nve/sphere\nthermo_modify norm no\n"
    fix = f"wall {law} {wall}" if wall else f"pair {law}"
    text += f"fix law all ilaw/{fix}\nvariable lost equal f_law[6]+f_law[7]\n"
    done = 0
    for k, steps in enumerate(spheres.steps_of(case, float(dt))):
        text, done = text + f"run {steps - done}\n" + state(f"end{k}"), steps
    lammps(tmp_path, text + 'print "$(v_lost:%.17g)" file lost\n', ranks)
    found = [[atom[1:] for atom in read(tmp_path, f"end{k}")] for k in range(len(case.ends))]
    return found, float((tmp_path / "lost").read_text())


@pytest.mark.parametrize("dt", some("1e-4", "3.7e-4", "7.3e-4"))
@pytest.mark.parametrize("name", spheres.CASES)
def test_spheres_turn_as_closed_forms_say(tmp_path, name, dt):
    case = spheres.CASES[name]
    ranks = 2 if not case.floor else 1  # spheres of a pair on either side of the border
    spheres.judge(case, float(dt), *roll(tmp_path, case, floor_of(case), dt, ranks))


# A ball at the bottom of a drum that rolls on it as fast as the drum turns stays where it is.
@pytest.mark.parametrize("shape", ["cylinder 0 0 0.2 1 0 0", "sphere 0 0 0.2"])
def test_a_ball_rolls_in_place_in_a_drum(tmp_path, shape):
    turns = 3.0
    place = [0, 0, spheres.RADIUS, 0, 0, 0, turns * 0.2 / spheres.RADIUS, 0, 0]
    ball = spheres.Sphere(place[:3], w=place[6:])
    drum = spheres.Case("drum", "", "rolling", {"friction": 0.5}, [ball], [(1.0, lambda t, h: (spheres.row(*place), 1e-12))])
    spheres.judge(drum, 1e-3, *roll(tmp_path, drum, f"{shape} 0.2 inside spin {turns} 0 0", "1e-3"))


@pytest.mark.parametrize("wall, lowest", [("cylinder 1.6 1.6 1.6 1 0 0 1.5 inside", 0.6),
                                          ("sphere 1.6 1.6 1.6 1.5 inside", 0.6),
                                          ("sphere 1.6 1.6 -1 1.2 outside", 0.7),
                                          ("plane 0 0 -0.5 0 0 1 velocity 0 0 1", 0.5)])
def test_walls_hold_where_they_are(tmp_path, wall, lowest):
    text = (BEGIN + BOX + "create_atoms 1 single 1.6 1.6 1.2\n" + MASS + INTEGRATE
            + f"fix w all ilaw/wall contact {wall}\nvariable z equal z[1]\n"
            + "thermo_style custom step v_z\nthermo 500\nrun 500\n")
    assert thermo(lammps(tmp_path, text))[-1][1] == pytest.approx(lowest, abs=2e-5)


@pytest.mark.parametrize("change, message", [
    (("newton off", "newton on"), "needs newton off: with newton on only one of two ranks finds"),
    (("coulomb friction 0.3 sweeps", "coulomb friction -1 sweeps"), "parameter 'friction'"),
    (("coulomb friction 0.3 sweeps", "no_such_law sweeps"), "no_such_law"),
    (("pair_style zero 1.2", "pair_style zero 0.9"), "has to be larger than the largest diameter"),
    (("pair coulomb", "pair coulomb mu 0.1"), "mu"),
    (("sweeps 30", "sweeps 1e300"), "sweeps is 1e300; expected a whole number from 1 to 1000000"),
    (("sweeps 30", "sweeps nan"), "sweeps is nan"),
    (("tol 1e-10", "tol inf"), "tol is inf; expected a finite number above 0"),
    (("tol 1e-10", "area nan tol 1e-10"), "area is nan; expected a finite number, 0 or above"),
    (("tol 1e-10", "area -1 tol 1e-10"), "area is -1"),
    (("fix nve all nve/sphere", "fix nve all nve"), "that fix nve/sphere moves, but fix nve does not rotate them"),
    (("plane 0 0 0 0 0 1 ", "plane 0 0 0 0 0 1 spin 0 1 1 "), "the spin of a plane must be along its normal"),
    (("friction 0.3 plane 0 0 0 0 0 1 ", "friction 0.3 spin 0 0 1 plane 0 0 0 0 0 1 "), "spin has to follow a wall"),
    (("coulomb friction 0.3 sweeps", "coulomb friction 0.3 rolling_friction 0.1 sweeps"), "rolling_friction"),
    (("tol 1e-10\n", "tol 1e-10\nfix late all gravity 1 vector 1 0 0\n"), "fix late comes later"),
])
def test_says_what_it_refuses(tmp_path, change, message):
    text = pile() + "run 1\n"
    assert change[0] in text
    with pytest.raises(RuntimeError, match=re.escape(message)):
        lammps(tmp_path, text.replace(*change))


@pytest.mark.parametrize("ranks", [1, 2])
def test_warns_of_grains_that_no_fix_has_together(tmp_path, ranks):
    text = pile().replace("fix nve", "group low id <= 13\ngroup high id > 13\nfix nve")
    apart = "fix p low ilaw/pair contact\nfix q {} ilaw/pair coulomb friction 0.3\nrun 1\n"
    text = text[:text.index("fix p")]
    warning = "grains of {} and of {} pass through each other"
    said = lammps(tmp_path, text + apart.format("high"), ranks)
    assert said.count(warning.format("group low", "group high")) == 1, said
    assert said.count("pass through each other") == 1
    said = lammps(tmp_path, text + "fix p low ilaw/pair contact\nrun 1\n", ranks)
    assert warning.format("no group of one", "group low") in said, said
    first = "fix r first ilaw/pair contact\n"  # grains of two fixes
    said = lammps(tmp_path, text.replace("fix nve", "group first id 1\nfix nve") + first + apart.format("high"), ranks)
    assert warning.format("group high", "group low and first") in said, said
    pushed = text.replace("style zero", "style lj/cut").replace("coeff * *", "coeff * * 0.0 1.0")
    for text in (text + apart.format("all"), pushed + apart.format("high")):
        assert "pass through each other" not in lammps(tmp_path, text, ranks)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_examples_run(tmp_path, example):
    text = example.read_text()
    assert "include ${ilaw}" in text
    shorter = re.sub(r"^run .*", "run 50", text, flags=re.M)
    rows = thermo(lammps(tmp_path, f"variable ilaw string {STYLES}\n" + shorter))
    assert rows[-1][0] >= 50


@pytest.mark.parametrize("dt", some("1e-3", "3.1e-4", "1e-4"))
def test_grazing_impacts_lose_what_friction_takes(tmp_path, dt):
    text = (EXAMPLES[0].parent / "in.graze").read_text()
    lammps(tmp_path, f"variable ilaw string {STYLES}\nvariable dt index {dt}\n" + text)
    rows = [list(map(float, line.split())) for line in (tmp_path / "graze.txt").read_text().splitlines()[-17:]]
    assert [round(row[0]) for row in rows] == list(range(5, 90, 5))
    for degrees, energy, speed in rows:
        sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        # Mass and radius 1, 1/2; friction 1/2 and restitution 1: it slides throughout, or rolls in the end.
        slides = sine > 3.5 * cosine
        assert speed == pytest.approx((sine - cosine) / sine if slides else 5 / 7, abs=1e-12), degrees
        after = (sine - cosine) ** 2 + 3.5 * cosine**2 if slides else cosine**2 + 5 / 7 * sine**2
        assert energy == pytest.approx(after, abs=1e-12), degrees


def last_row(tmp_path, name, example, **variables):
    text = f"variable ilaw string {STYLES}\n" + "".join(f"variable {k} index {v}\n" for k, v in variables.items())
    lammps(tmp_path, text + (EXAMPLES[0].parent / example).read_text())
    return list(map(float, (tmp_path / name).read_text().splitlines()[-1].split()))


def test_the_example_of_a_ball_has_the_figures_of_its_page(tmp_path):
    assert last_row(tmp_path, "roll.txt", "in.roll")[1:] == pytest.approx([1.783894, 0, 0], abs=1e-6)
    _, x, _, spin = last_row(tmp_path, "roll.txt", "in.roll", model="sds", dt="1e-4")
    assert x == pytest.approx(1.7788, abs=1e-4) and spin > 0.05


def test_a_heap_stays_with_rolling_resistance_and_flattens_without(tmp_path):
    _, _, height, away, _ = last_row(tmp_path, "heap.txt", "in.heap", end=1)
    assert height > 4 and away < 5
    _, _, height, away, _ = last_row(tmp_path, "heap.txt", "in.heap", end=1, resistance=0)
    assert height < 2 and away > 12


@pytest.mark.parametrize("dt", some("3e-7", "7.3e-8", "1e-8"))
def test_adhesive_grains_leave_with_what_their_neck_leaves_them(tmp_path, dt):
    text = (EXAMPLES[0].parent / "in.stick").read_text()
    lammps(tmp_path, f"variable ilaw string {STYLES}\nvariable dt index {dt}\n" + text)
    rows = [list(map(float, line.split())) for line in (tmp_path / "stick.txt").read_text().splitlines()[-5:]]
    assert [row[0] for row in rows] == [0.9, 1.1, 1.5, 2, 3]
    assert rows[0][1] < 0.9  # held
    for before, after in rows[1:]:
        assert after == pytest.approx(math.sqrt(before**2 - 1), rel=1e-6)


def test_the_comparison_with_pair_granular_runs(tmp_path):
    script = EXAMPLES[0].parent / "compare.py"
    options = ("--across 4 --layers 4 --settling 0.03 --shearing 0.004 --steps 1e-4 2e-4 --own-steps 2e-5 4e-5 "
               "--bound 1").split()
    done = subprocess.run([sys.executable, script, "--ilaw", STYLES, *options], cwd=tmp_path, env=ENVIRONMENT,
                          text=True, timeout=300, stdout=subprocess.PIPE, check=True)
    rows = [line.split("|")[2:-1] for line in done.stdout.splitlines() if line.startswith("| ")][2:]
    assert [float(row[0]) for row in rows] == [100, 200, 20, 40]
    # Both models have the same grains fall the same height onto the same floor.
    assert all(0.0 <= float(row[4].rstrip("% ")) < 5.0 for row in rows), rows  # 0.0 % is below 0.05 %
    assert "over coulomb: step 0.2, CPU" in done.stdout
