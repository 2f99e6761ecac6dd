"""The cycle of OpenRadioss as sync(context) sees it, with numpy arrays: no OpenRadioss, no line of it.

A model has nodes, masses, springs between nodes (bars), and a force. Components that a /BCS holds get no
acceleration; nodes with a kinematic condition have IKINE 1.
"""
import numpy as np


class Engine:
    def __init__(
        self, x, v=0.0, mass=1.0, force=None, bars=(), stiffness=0.0, bcs=(), bound=(), users=None, ranks=None
    ):  # fmt: skip
        n = len(x)
        self.start, self.force, self.bars, self.stiffness = np.array(x, float), force, np.array(bars, int), stiffness
        self.free = np.ones((n, 3))
        for node, axis in bcs:
            self.free[node, axis] = 0.0
        self.arrays = dict(
            X=self.start.copy(), V=np.zeros((n, 3)) + v, D=np.zeros((n, 3)), MS=np.zeros(n) + mass,
            ITAB=np.arange(1, n + 1, dtype=np.int32) if users is None else np.array(users, np.int32),
            IKINE=np.zeros(n, np.int32), WEIGHT=np.ones(n, np.int32) if ranks is None else np.array(ranks, np.int32),
        )  # fmt: skip
        self.arrays["IKINE"][list(bound)] = 1
        self.time = self.last = 0.0

    @property
    def context(self):
        """What the engine passes to sync: addresses, sizes and types of its arrays."""
        made = {}
        for name, array in self.arrays.items():
            kind = "int" if array.dtype == np.int32 else "double"
            made |= {name + "_ptr": array.ctypes.data, name + "_size": array.size, name + "_type": kind}
        return made

    def forces(self):
        x, d = self.arrays["X"], self.arrays["D"]
        f = np.zeros_like(x) if self.force is None else self.force(self.time, x) + np.zeros_like(x)
        if len(self.bars):
            i, j = self.bars.T
            along = self.start[j] - self.start[i]
            along /= np.linalg.norm(along, axis=1)[:, None]
            pull = self.stiffness * np.einsum("ki,ki->k", d[j] - d[i], along)[:, None] * along
            np.add.at(f, i, pull)
            np.add.at(f, j, -pull)
        return f

    def run(self, sync, steps):
        """Cycles of these lengths; sync(context, time, step) is called once before the first one, too."""
        sync(self.context, self.time, self.last)
        for step in steps:
            a = self.forces() / self.arrays["MS"][:, None] * self.free
            self.arrays["V"] += 0.5 * (self.last + step) * a
            self.arrays["X"] += step * self.arrays["V"]
            self.arrays["D"] += step * self.arrays["V"]
            self.time, self.last = self.time + step, step
            sync(self.context, self.time, step)
            yield self.time


def wobble(h, end):
    """Steps that vary by a fifth."""
    lengths = [h, 0.9 * h, 0.8 * h, 0.9 * h]
    return [lengths[k % 4] for k in range(int(end / (0.9 * h)))]


def bar(cells, length, first_x, mass_per_length, cross=1):
    """Nodes (x, y, z) and masses of a bar along x, with cross x cross lines of nodes, and its springs."""
    lines = [(y, z) for y in np.linspace(0, 0.02, cross) for z in np.linspace(0, 0.02, cross)]
    ends = np.linspace(first_x, first_x + length, cells + 1)
    x = np.array([(a, y, z) for y, z in lines for a in ends])
    share = np.ones(cells + 1)
    share[[0, -1]] = 0.5
    mass = np.tile(share * mass_per_length * length / cells / len(lines), len(lines))
    bars = [(k * (cells + 1) + c, k * (cells + 1) + c + 1) for k in range(len(lines)) for c in range(cells)]
    return x, mass, bars
