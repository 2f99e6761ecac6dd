#!/usr/bin/env python3
"""The coupled solver beside the solvers of Siconos on problems of frictional contact in files: processor time to a
residual of 1e-4 and of 1e-8, and performance profiles (Dolan, More 2002).

    contact_problems.py FOLDER --picture profiles.png       needs PYTHONPATH=api/python, ILAW_PATH, ILAW_LOADER

A file is of FCLIB (*.hdf5, the group fclib_local) or a text as Siconos writes it (*.dat, FrictionContactProblem): the
dimension 3, the number of contacts, the matrix W as dense (0) or in sparse 3 x 3 blocks (1), velocities without impulses
q, coefficients of friction. W is made symmetric, positive semidefinite, and scaled to a mean diagonal of 1. The residual
is the natural map over |q|. The coupled solver knows bodies, so W is factored into B B': a column of three is a body that
gives way alike in all directions, and rows of B are the weights of a contact. A profile is the part of the problems that
a solver solves within a multiple of the time of the fastest one on each.
"""
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import ctypes
import ctypes.util
import os
import resource
import sys
import tempfile
import time
import typing
from pathlib import Path

import numpy as np
import scipy.sparse

import ilaw
from ilaw.coupled import Bodies, Contacts, Solver

OURS, LEAST = "ilaw coupled", 1e-5  # seconds: shorter times count as this
TARGETS = (1e-4, 1e-8)
SICONOS = {"NSGS": 500, "NSGSV": 501, "PROX": 502, "TFP": 503, "NSN_AC": 504, "DSFP": 505, "FPP": 511, "EG": 512, "NSN_FB": 513,
           "ACLMFP": 516, "NSN_NM": 520, "PFP": 522, "ADMM": 523}  # fmt: skip


class Problem(typing.NamedTuple):
    w: scipy.sparse.csr_matrix
    q: np.ndarray
    friction: np.ndarray

    def residual(self, r):
        """The natural map |r - P(r - (u + mu |u_t| n))| over |q|, P the projection to the cone of friction."""
        u = (self.w @ r + self.q).reshape(-1, 3)
        z = r.reshape(-1, 3) - u
        z[:, 0] -= self.friction * np.hypot(u[:, 1], u[:, 2])
        size, mu = np.hypot(z[:, 1], z[:, 2]), self.friction
        normal = np.where(size > mu * z[:, 0], (mu * size + z[:, 0]) / (mu**2 + 1), z[:, 0])
        along = np.where(size > mu * z[:, 0], mu * normal / np.maximum(size, 1e-300), 1.0)
        projected = np.column_stack([normal, along * z[:, 1], along * z[:, 2]])
        projected[mu * size <= -z[:, 0]] = 0.0
        return np.linalg.norm(r.reshape(-1, 3) - projected) / np.linalg.norm(self.q)


# ---- files ----


def from_text(file):
    numbers = iter(file.read_text().split())

    def take(count, kind=float):
        return np.array([kind(next(numbers)) for _ in range(count)])

    dimension, contacts, storage, _, _ = take(5, int)
    if dimension != 3 or storage not in (0, 1):
        return None
    if storage == 0:
        rows, columns = take(2, int)
        w = scipy.sparse.csr_matrix(take(rows * columns).reshape(columns, rows).T)
    else:
        _, rows, columns = take(3, int)
        take(rows + columns, int)
        starts, indices = take(2, int)
        start, index = take(starts, int), take(indices, int)
        blocks = take(10 * indices).reshape(-1, 10)[:, 1:].reshape(-1, 3, 3).transpose(0, 2, 1)
        w = scipy.sparse.bsr_matrix((blocks, index, start), shape=(3 * contacts, 3 * contacts)).tocsr()
    return w, take(3 * contacts), take(contacts)


class Matrix(ctypes.Structure):  # of fclib.h
    _fields_ = [("nzmax", ctypes.c_int), ("m", ctypes.c_int), ("n", ctypes.c_int), ("p", ctypes.POINTER(ctypes.c_int)),
                ("i", ctypes.POINTER(ctypes.c_int)), ("x", ctypes.POINTER(ctypes.c_double)), ("nz", ctypes.c_int)]  # fmt: skip


class Local(ctypes.Structure):
    _fields_ = [(name, ctypes.POINTER(Matrix)) for name in "WVR"] + [
        (name, ctypes.POINTER(ctypes.c_double)) for name in ("mu", "q", "s")] + [("spacedim", ctypes.c_int)]  # fmt: skip


def from_fclib(file):
    """Problems of fclib_global have no W."""
    library = ctypes.CDLL(ctypes.util.find_library("fclib"))
    library.fclib_read_local.restype = ctypes.POINTER(Local)
    read = library.fclib_read_local(str(file).encode())
    if not read or read[0].spacedim != 3 or read[0].V:
        return None
    local, w = read[0], read[0].W[0]
    lines = w.m if w.nz == -2 else w.n
    count = w.nz if w.nz >= 0 else w.p[lines]  # triplets, else columns (-1) or rows (-2)
    i, x = np.array(w.i[:count]), np.array(w.x[:count])
    p = np.array(w.p[:count]) if w.nz >= 0 else np.repeat(np.arange(lines), np.diff(w.p[: lines + 1]))
    row, column = (p, i) if w.nz == -2 else (i, p)
    made = scipy.sparse.coo_matrix((x, (row, column)), shape=(w.m, w.n)).tocsr()
    return made, np.array(local.q[: w.m]), np.array(local.mu[: w.m // 3])


def read(file):
    """A problem, B and the largest |W - W'|, and change of W by B B', over its largest entry; None where there is none."""
    found = from_fclib(file) if file.suffix == ".hdf5" else from_text(file)
    if found is None:
        print(f"{file}: not a local problem of contacts in dimension 3", file=sys.stderr)
        return None
    w, q, friction = found
    asymmetry = abs(w - w.T).max() / abs(w).max()
    w = 0.5 * (w + w.T) * (w.shape[0] / w.trace())
    b = factor(w.tocsr())
    return Problem((b @ b.T).tocsr(), q, friction), b, asymmetry, abs(b @ b.T - w).max() / abs(w).max()


def factor(w):
    """B with few entries: contacts with the fewest neighbors first. A pivot of zero, of a redundant contact, has no
    column."""
    rest = [dict(zip(w.indices[a:b].tolist(), w.data[a:b].tolist())) for a, b in zip(w.indptr, w.indptr[1:])]
    entries, left = [], set(range(len(rest) // 3))
    while left:
        contact = min(left, key=lambda k: len(rest[3 * k]))
        left.remove(contact)
        for pivot in range(3 * contact, 3 * contact + 3):
            column, rest[pivot] = rest[pivot], {}
            value = column.get(pivot, 0.0)
            for i in column.keys() - {pivot}:
                rest[i].pop(pivot, None)
            if not value > 1e-13:
                continue
            entries += [(i, pivot, x / value**0.5) for i, x in column.items()]
            for i, x in column.items():
                for j, y in column.items():
                    if pivot not in (i, j):
                        rest[i][j] = rest[i].get(j, 0.0) - x * y / value
    row, column, values = zip(*entries)
    return scipy.sparse.csr_matrix((values, (row, column)), shape=w.shape)


# ---- solvers ----


def mean_seconds(call):
    """Processor time, the mean of as many calls as take 30 ms together: the clock of some systems is coarse."""
    start, calls, spent = time.process_time(), 0, 0.0
    while calls == 0 or calls < 10000 and spent < 0.03:
        call()
        calls, spent = calls + 1, time.process_time() - start
    return spent / calls


class Coupled:
    """Bodies at rest, which the walls of contacts meet with -q. A contact has its column of three as a body."""

    def __init__(self, problem, b):
        count, self.problem = len(problem.friction), problem
        columns = [np.unique(b.indices[b.indptr[3 * k] : b.indptr[3 * k + 3]] // 3) for k in range(count)]
        width = max(map(len, columns))
        body, weight = np.full((count, width), -1), np.zeros((count, width, 3, 3))
        for k, own in enumerate(columns):
            body[k, : len(own)] = own
            for e, column in enumerate(own):
                weight[k, e] = b[3 * k : 3 * k + 3, 3 * column : 3 * column + 3].toarray()
        self.bodies = Bodies(v_free=np.zeros((count, 3)), v_previous=np.zeros((count, 3)), inverse_mass=1.0)
        self.groups, self.solver = [], Solver()
        for mu in np.unique(problem.friction):
            mine = problem.friction == mu
            law = ilaw.Interface("coulomb", delassus="full", velocity_step=1.0, friction=mu)
            contacts = Contacts(law, body=body[mine], counterpart=np.full(mine.sum(), -1), normal=[1.0, 0.0, 0.0], gap=0.0,
                                body_weight=weight[mine], wall_velocity=-problem.q.reshape(-1, 3)[mine],
                                wall_previous=np.zeros(3))  # no velocity before: nothing bounces  # fmt: skip
            self.groups.append((mine, contacts))

    def solve(self, tolerance, iterations):
        """Seconds and residual."""

        def call():
            for _, contacts in self.groups:
                contacts.impulse[:] = 0.0
            groups = [contacts for _, contacts in self.groups]
            self.solver.solve(self.bodies, groups, time=1.0, tolerance=tolerance, most_sweeps=iterations)

        seconds, r = mean_seconds(call), np.zeros((len(self.problem.friction), 3))
        for mine, contacts in self.groups:
            r[mine] = contacts.impulse
        return seconds, self.problem.residual(r.ravel())

    def times(self, limit):
        """Tolerances are tried from coarse to fine, because the solver's residual is another one."""
        most, found, tolerance = int(min(1e6, 1 + limit / (self.solve(1e-300, 50)[0] / 50))), [], 1e-3
        for target in TARGETS:
            found.append(np.inf)
            while found[-1] == np.inf and tolerance > 1e-15:
                seconds, residual = self.solve(tolerance, most)
                tolerance *= 0.1
                if seconds > limit:
                    break
                if residual < target:
                    found[-1] = max(seconds, LEAST)
        return tuple(found)


class Options(ctypes.Structure):  # the first members of SolverOptions.h
    _fields_ = [("id", ctypes.c_int), ("is_set", ctypes.c_bool), ("integers", ctypes.c_int),
                ("iparam", ctypes.POINTER(ctypes.c_int)), ("doubles", ctypes.c_int),
                ("dparam", ctypes.POINTER(ctypes.c_double))]  # fmt: skip


def write_for_siconos(problem, file):
    """W in sparse blocks of 3 x 3, each by columns."""
    blocks, n = problem.w.tobsr((3, 3)), len(problem.friction)
    blocks.sort_indices()
    ends, count = " ".join(str(3 * k) for k in range(1, n + 1)), len(blocks.indices)
    lines = [3, n, 1, f"{3 * n} {3 * n}", count, f"{n} {n}", ends, ends, f"{n + 1} {count}",
             " ".join(map(str, blocks.indptr)), " ".join(map(str, blocks.indices))]  # fmt: skip
    for k, block in enumerate(blocks.data):
        lines += [k, *map(repr, block.T.ravel().tolist())]
    file.write_text("\n".join(map(str, [*lines, *problem.q.tolist(), *problem.friction.tolist()])) + "\n")


def siconos_seconds(library, problem, file, solver, target, limit):
    library.frictionContact_new_from_filename.restype = ctypes.c_void_p
    library.solver_options_create.restype = ctypes.POINTER(Options)
    theirs, r = ctypes.c_void_p(library.frictionContact_new_from_filename(str(file).encode())), np.zeros(len(problem.q))
    velocity, tolerance = np.zeros_like(r), target

    def call():
        r[:], velocity[:], options = 0.0, 0.0, library.solver_options_create(solver)
        options[0].iparam[0], options[0].dparam[0] = 10000000, tolerance
        library.fc3d_driver(theirs, *(ctypes.c_void_p(array.ctypes.data) for array in (r, velocity)), options)
        library.solver_options_delete(options)

    while tolerance > 1e-15:
        seconds = mean_seconds(call)
        if problem.residual(r) < target and seconds < limit:
            return max(seconds, LEAST)
        tolerance *= 0.1
    return np.inf


def apart(call, limit):
    """What a call returns in a process of its own, since some solvers do not return or crash: infinity then."""
    reads, writes = os.pipe()
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        try:
            resource.setrlimit(resource.RLIMIT_CPU, 2 * (int(np.ceil(time.process_time() + limit)),))
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1), os.dup2(null, 2)
            os.write(writes, repr(float(call())).encode())
        finally:
            os._exit(0)
    os.close(writes)
    with os.fdopen(reads) as said:
        seconds = said.read()
    os.waitpid(child, 0)
    return float(seconds) if seconds else np.inf


def times(given, files):
    """{problem: {solver: seconds to 1e-4, to 1e-8}}, and rows of the problems: contacts, asymmetry, change."""
    found, problems = {}, {}
    name = ctypes.util.find_library("siconos_numerics")
    library = ctypes.CDLL(name) if name else None
    for file in files:
        read_one = read(file)
        if read_one is None or len(read_one[0].friction) < given.least:
            continue
        problem, b, *changes = read_one
        problems[file.name] = [str(len(problem.friction)), *(f"{change:.1e}" for change in changes)]
        found[file.name] = {OURS: Coupled(problem, b).times(given.limit)}
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "problem.dat"
            write_for_siconos(problem, copy)
            for solver, number in SICONOS.items() if library else ():
                found[file.name][solver] = tuple(
                    apart(lambda: siconos_seconds(library, problem, copy, number, target, given.limit), given.limit)
                    for target in TARGETS)  # fmt: skip
    return found, problems


def ratios(found, target):
    """{solver: its times over those of the fastest on each problem that any solver solved}."""
    seconds = {name: {solver: pair[target] for solver, pair in of.items()} for name, of in found.items()}
    solved = [of for of in seconds.values() if min(of.values()) < np.inf]
    return {solver: np.array([of[solver] / min(of.values()) for of in solved]) for solver in next(iter(found.values()))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--limit", type=float, default=1.0, help="seconds for a solver, a problem and a residual")
    parser.add_argument("--least", type=int, default=20, help="contacts of the smallest problem that counts")
    parser.add_argument("--picture", metavar="FILE", type=Path)
    given = parser.parse_args()
    files = sorted(file for file in given.folder.iterdir() if file.suffix in (".dat", ".hdf5"))
    found, problems = times(given, files)
    print("| problem | contacts | W - W' | changed by | ilaw, 1e-4 | fastest other | ilaw, 1e-8 | fastest other |\n" + "| --- " * 8 + "|")
    for name, of in found.items():
        cells = []
        for target in (0, 1):
            best = min(((pair[target], solver) for solver, pair in of.items() if solver != OURS), default=(np.inf, ""))
            cells += [f"{1e3 * of[OURS][target]:.2g} ms", f"{1e3 * best[0]:.2g} ms, {best[1]}" if best[0] < np.inf else "-"]
        print(f"| {name} | {' | '.join(problems[name])} | {' | '.join(cells)} |".replace("inf ms", "-"))
    print("\n| solver | solved to 1e-4 | within twice the fastest | solved to 1e-8 | within twice the fastest |\n" + "| --- " * 5 + "|")
    both = [ratios(found, target) for target in (0, 1)]
    order = sorted(both[0], key=lambda solver: -sum(np.isfinite(each[solver]).sum() for each in both))
    for solver in order:
        cells = [f"{np.isfinite(each[solver]).sum()} | {(each[solver] <= 2).sum()}" for each in both]
        print(f"| {solver} | {' | '.join(cells)} |")
    print(f"\n{len(found)} problems, {given.limit:g} s each")
    if given.picture:
        picture(both, order, len(found), given.picture)


def picture(both, order, count, file):
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"axes.spines.top": False, "axes.spines.right": False})
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.4), sharey=True)
    tau = np.logspace(0, 4, 400)
    for plot, each, target in zip(axes, both, ("1e-4", "1e-8")):
        for solver in order[:7]:
            share = [(each[solver] <= t).sum() / count for t in tau]
            plot.semilogx(tau, share, label=solver, lw=2.4 if solver == OURS else 1.1)
        plot.set_xlabel(f"multiple of the fastest time, residual {target}")
    axes[0].set_ylabel("part of the problems")
    axes[1].legend(fontsize=7, frameon=False, loc="lower right")
    figure.tight_layout()
    figure.savefig(file)


if __name__ == "__main__":
    main()
