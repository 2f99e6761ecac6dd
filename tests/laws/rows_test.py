# Closed forms of laws: each row of <law>/rows.json drives nodes of the law through the ABI, and says what must come out.
#
#   of            the claim, with its source if it is not derived on the law's page
#   each          values whose combinations are runs of their own
#   nodes         values whose combinations are the nodes of one batch; or a number of nodes, for draws, which are
#                 uniform(low, high), decades(low, high) and direction()
#   let           names for expressions, of nodes and of what stands above; "define" at the top serves all rows of a file
#   law, dimension, form, parameters    of the instance. Text that begins with "=" is computed, and one value per node is
#                 given per node
#   start         once: u (position), v, state
#   h, l, time    velocity step, position step (h) and time (k*h) of each step
#   gap, area, H, v_before, v_free, state, normal, tangent    inputs of each step. Left out, the gap is u0 if there is a
#                 start and 0 else, and both velocities are v after the last step
#   keep          names with a value to start from and one after each step, such as the largest force
#   steps, until  the number of steps (1); an expression that ends them
#   always        must be true at all nodes after each step; expect: after the last one
#   occurs        how often at least an expression is true over all nodes, steps and runs
#   order         of convergence: of an error over the first list of "each", which has the steps
#   finer         values of "each" for a run whose results expressions see as fine.u0
#   twin          what differs for a second set of nodes with the same inputs, which expressions see as twin.v0
#   may_refuse    nodes with bad input may occur; reason says why
#
# Expressions are numpy's, with near(a, b, tolerance) and the results u0, v0, r0 ..., w0 (the velocity before), f0
# (v_free), status, friction, impact, rupture, stored (energy), the state and the amounts by name, k (steps done), t, h,
# l, n.
import contextlib
import functools
import itertools
import json
import pathlib
import sys
import types
import unittest

import ilaw
import numpy as np

HERE = pathlib.Path(__file__).parent
VECTORS, SCALARS = ("v_free", "v_before", "normal", "tangent"), ("gap", "area")
KEYS = {"of", "each", "nodes", "let", "law", "dimension", "form", "parameters", "start", "h", "l", "time", *VECTORS, *SCALARS,
        "H", "state", "keep", "steps", "until", "always", "expect", "occurs", "order", "finer", "twin", "may_refuse"}
ENERGIES = ("friction", "impact", "rupture", "stored")


def bisection(function, low, high):
    """Where a function that is positive at low, and not at high, changes its sign."""
    low, high = np.broadcast_arrays(np.float64(low), np.float64(high))
    for _ in range(200):
        middle = 0.5*(low + high)
        is_left = function(middle) > 0
        low, high = np.where(is_left, middle, low), np.where(is_left, high, middle)
    return low


def runge_kutta(rate, start, begin, end, steps):
    """y' = rate(t, y) by the method of fourth order."""
    y, h = np.array(start, float), (end - begin)/steps
    for k in range(steps):
        t = begin + k*h
        a = rate(t, y)
        b = rate(t + 0.5*h, y + 0.5*h*a)
        c = rate(t + 0.5*h, y + 0.5*h*b)
        y = y + h/6*(a + 2*b + 2*c + rate(t + h, y + h*c))
    return y


@functools.cache
def compiled(text):
    return compile(text, text, "eval")


def unit(vectors):
    return vectors/np.linalg.norm(vectors, axis=1, keepdims=True)


def inputs_of(mask):
    return [one.name.lower() for one in type(mask) if one & mask]


def value(text, names):
    return eval(compiled(text), names) if isinstance(text, str) else text


def computed(one, names):
    """Text that begins with "=", or what stands there."""
    return value(one[1:], names) if isinstance(one, str) and one.startswith("=") else one


def rows_of(given, names, count, size):
    """An array (count, size) of a list of components, or of one expression; what is left out is 0."""
    if not isinstance(given, list):
        one = np.asarray(value(given, names), float)
        return np.broadcast_to(one if size > 1 else one.reshape(-1, 1), (count, size))
    columns = [np.broadcast_to(value(one, names), count) for one in given]
    return np.stack(columns + [np.zeros(count)]*(size - len(columns)), axis=1)


class Nodes:
    """A batch of a row, its inputs and its state."""

    def __init__(self, row, names, count):
        self.row, self.count = row, count
        given = {key: computed(one, names) for key, one in computed(row.get("parameters", {}), names).items()}
        self.d = computed(row.get("dimension", 3), names)
        frame = "global" if "normal" in row else "local"
        self.interface = ilaw.Interface(row["law"], dimension=self.d, frame=frame, parameters=given,
                                        tangent="tangent" in row,
                                        delassus=computed(row.get("form", "scalar"), names))
        self.inputs = {**{name: np.zeros((count, self.d)) for name in VECTORS},
                       **{name: np.zeros((count, 1)) for name in SCALARS},
                       "H": np.zeros((count, self.interface.delassus_components))}
        one = self.inputs
        self.batch = self.interface.batch(
            v_free=one["v_free"], v_previous=one["v_before"], delassus=one["H"], gap=one["gap"][:, 0],
            area=one["area"][:, 0], velocity=True, energy=True, amounts=True,
            **{name: one[name] for name in ("normal", "tangent") if name in row})
        one["area"][:] = 1
        self.v, self.u = np.zeros((count, self.d)), np.zeros((count, self.d))

    def begin(self, names):
        start, self.moves = self.row.get("start", {}), "start" in self.row
        with contextlib.suppress(*[ilaw.BadNodes] if self.row.get("may_refuse") else []):
            self.batch.initialise(float(value(self.row.get("time", 0), names)))
        self.set_state(start.get("state", {}), names)
        for name in ("u", "v"):
            getattr(self, name)[:] = rows_of(start.get(name, [0]), names, self.count, self.d)

    def set_state(self, given, names):
        if isinstance(given, str):
            self.batch.state[:] = rows_of(given, names, self.count, self.batch.state.shape[1])
            return
        for name, one in given.items():
            self.batch.variable(name)[:] = rows_of(one, names, self.count, self.batch.variable(name).shape[1])

    def step(self, names, time, h, l, others):
        """others: inputs of the first set, where this is the second."""
        row, inputs = self.row, self.inputs
        inputs["v_before"][:] = inputs["v_free"][:] = self.v
        inputs["gap"][:] = self.u[:, :1] if self.moves else 0
        for name, array in inputs.items():
            given = row.get(name, 1 if name == "H" else None)
            if others and name not in row["twin"]:
                array[:] = others[name]
            elif given is not None:
                array[:] = rows_of(given, names, self.count, array.shape[1])
        self.set_state(row.get("state", {}), names)
        report = self.batch.evaluate(time, h, l, bad_nodes="report")
        self.v[:] = self.batch.velocity
        self.u += l*self.v
        return report

    def results(self):
        batch = self.batch
        found = {"status": batch.status, "u": self.u, "v": self.v, "r": batch.impulse, "w": self.inputs["v_before"],
                 "f": self.inputs["v_free"], "state": batch.state, **dict(zip(ENERGIES, batch.energy.T)), **batch.amounts}
        for name in ("u", "v", "r", "w", "f"):
            found |= {f"{name}{c}": found[name][:, c] for c in range(self.d)}
        for one in self.interface.state_variables:
            found[one.name] = batch.variable(one.name)[:, 0] if one.count == 1 else batch.variable(one.name)
        return found


def fault_of(text, names):
    """Where an expression is not true; with the numbers of what is not near."""
    is_true = np.asarray(value(text, names))
    if is_true.dtype != bool or is_true.size == 0:
        return f"{text}: {is_true.dtype} of shape {is_true.shape}, expected something that is true"
    if np.all(is_true):
        return ""
    first = int(np.flatnonzero(~is_true)[0])
    said = f"{text}: not at {np.sum(~is_true)} of {is_true.size} nodes, node {first}"
    seen = []
    value(text, {**names, "near": lambda *given: seen.append(given) or names["near"](*given)})
    for given in seen:
        numbers = [np.broadcast_to(one, np.broadcast_shapes(*map(np.shape, given))).ravel() for one in given]
        worst = int(np.nanargmax(np.abs(numbers[0] - numbers[1]) - numbers[2]))
        said += f"; found {numbers[0][worst]!r}, expected {numbers[1][worst]!r} to {numbers[2][worst]:.3g} (at {worst})"
    return said


class Run:
    """One combination of a row's values."""

    def __init__(self, row, define, given, seed):
        draw = np.random.default_rng(seed)
        nodes = row.get("nodes", 1)
        lists = {} if isinstance(nodes, int) else {key: value(one, vars(np)) for key, one in nodes.items()}
        grids = np.meshgrid(*map(np.asarray, lists.values()), indexing="ij") if lists else []
        self.row, self.n = row, grids[0].size if grids else nodes if isinstance(nodes, int) else 1
        self.faults = []
        self.names = names = {
            **vars(np), **ilaw.Status.__members__, "n": self.n, "max": np.maximum, "min": np.minimum,
            "ulp": np.finfo(float).eps, "norm": np.linalg.norm, "bisection": bisection, "runge_kutta": runge_kutta,
            "near": lambda a, b, tolerance: np.abs(a - b) <= tolerance, "implies": lambda a, b: ~np.asarray(a) | b,
            "uniform": lambda low=-1, high=1: draw.uniform(low, high, self.n),
            "decades": lambda low, high: 10**draw.uniform(low, high, self.n),
            "direction": lambda: unit(draw.normal(size=(self.n, 3))),
            "reads": lambda name: name in inputs_of(self.nodes.interface.inputs),
            "reads_for_balances": lambda name: name in inputs_of(self.nodes.interface.balance_inputs)}
        for name, text in define.items():
            names[name] = value(text, names)
        names |= {**{key: grid.ravel() for key, grid in zip(lists, grids)}, **given}
        for name, text in row.get("let", {}).items():
            if name in ("u", "v", "r", "w", "f", "k", "t", "l", "n"):
                raise ValueError(f"{row['of']}: let {name}, which is a result")
            names[name] = value(text, names)
        if "finer" in row:
            driven = {key: one for key, one in row.items()
                      if key not in ("finer", "always", "expect", "occurs", "order")}
            fine = Run(driven, define, {**given, **row["finer"]}, seed)
            self.faults += fine.faults
            names["fine"] = types.SimpleNamespace(**fine.nodes.results())
        self.counts, self.error = dict.fromkeys(row.get("occurs", {}), 0), None
        self.drive()

    def judge(self, part):
        self.faults += filter(None, (fault_of(text, self.names) for text in self.row.get(part, [])))

    def drive(self):
        row, names = self.row, self.names
        sets = [self.nodes] = [Nodes(row, names, self.n)]
        if "twin" in row:
            sets.append(Nodes({**row, **row["twin"]}, names, self.n))
        names |= {"k": 0, "t": 0.0}
        names |= {name: value(first, names) for name, (first, _) in row.get("keep", {}).items()}
        h = names["h"] = float(value(row.get("h", 1e-3), names))
        names["l"] = float(value(row.get("l", h), names))
        for one in sets:
            one.begin(names)
        self.see(sets)
        for k in range(int(value(row.get("steps", 1), names))):
            names["k"] = k
            h = names["h"] = float(value(row.get("h", 1e-3), names))
            l = names["l"] = float(value(row.get("l", h), names))
            time = names["t"] = float(value(row.get("time", "k*h"), names))
            reports = [one.step(names, time, h, l, {} if one is sets[0] else sets[0].inputs) for one in sets]
            self.see(sets)
            names |= {"k": k + 1, "reason": reports[0].reason, "bad": reports[0].bad_count}
            for report in reports:
                if report.bad_count and not row.get("may_refuse"):
                    self.faults.append(f"step {k}: {report.bad_count} bad nodes: {report.reason}")
            names |= {name: value(then, names) for name, (_, then) in row.get("keep", {}).items()}
            self.judge("always")
            for text in self.counts:
                self.counts[text] += int(np.sum(value(text, names)))
            if self.faults:
                self.faults.insert(0, f"after step {k}")
                return
            if "until" in row and np.all(value(row["until"], names)):
                break
        else:
            if "until" in row:
                self.faults.append(f"{row['until']}: not reached")
        self.judge("expect")
        if "order" in row:
            self.error = float(np.max(value(row["order"]["error"], names)))

    def see(self, sets):
        self.names.update(sets[0].results())
        if len(sets) > 1:
            self.names["twin"] = types.SimpleNamespace(**sets[1].results())


def faults_of(row, define, number):
    """What a row finds otherwise, by the values of the run that found it."""
    if row.keys() - KEYS or not row.keys() & {"always", "expect", "order"}:
        return [f"keys no row has: {sorted(row.keys() - KEYS)}, and always, expect or order must be there"]
    each = {key: value(one, vars(np)) for key, one in row.get("each", {}).items()}
    runs = [(given, Run(row, define, dict(zip(each, given)), [number, k]))
            for k, given in enumerate(itertools.product(*each.values()))]
    found = [f"{dict(zip(each, given))}: {fault}" for given, run in runs for fault in run.faults]
    if found:
        return found
    for text, least in row.get("occurs", {}).items():
        count = sum(run.counts[text] for _, run in runs)
        if count < least:
            found.append(f"{text}: {count} times, expected {least}")
    if "order" in row:
        others = {}
        for given, run in runs:
            others.setdefault(given[1:], []).append((given[0], run.error))
        for key, errors in others.items():
            slope = np.polyfit(*np.log(np.array(errors).T), 1)[0]
            if not abs(slope - row["order"]["is"]) <= row["order"]["to"]:
                found.append(f"{key}: order {slope:.3f} of the errors {errors}")
    return found


class Rows(unittest.TestCase):
    pass


def add_tests(law):
    table = json.loads((HERE / law / "rows.json").read_text())
    for number, row in enumerate(table["rows"]):
        def test(self, row={"law": law, **row}, number=number):
            with np.errstate(all="ignore"):
                self.assertEqual(faults_of(row, table.get("define", {}), number), [])
        setattr(Rows, f"test_{number:02d} {row['of']}", test)


if __name__ == "__main__":
    laws = [one for one in sys.argv[1:] if (HERE / one / "rows.json").is_file()]
    for law in laws or sorted(file.parent.name for file in HERE.glob("*/rows.json")):
        add_tests(law)
    unittest.main(argv=[sys.argv[0], *(one for one in sys.argv[1:] if one not in laws)])
