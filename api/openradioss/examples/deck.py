"""Decks of OpenRadioss with interface laws: starter file, engine file, and the contacts beside them.

SPDX-License-Identifier: BSD-3-Clause
"""
from pathlib import Path

PYTHON = """\
def sync(context):
    import ilaw_openradioss, ilaw_contacts
    ilaw_openradioss.sync(context, TIME, DT, ilaw_contacts.contacts, history="history.csv")
"""

WINDOW = """\
def sync(context):
    import ctypes, ilaw_openradioss_window
    ilaw_openradioss_window.sync(context, TIME, DT)
    def array(name, kind):
        return (kind * context[name + "_size"]).from_address(context[name + "_ptr"])
    z = 3 * array("ITAB", ctypes.c_int)[:].index(1) + 2
    x, v = (array(name, ctypes.c_double)[z] for name in "XV")
    with open("history.csv", "a") as table:
        table.write(f"{TIME!r},{x!r},{v!r}\\n")
"""


def number(x):
    return f"{x:20.12g}"


def whole(n):
    return f"{n:10d}"


class Deck:
    """The blocks of a model, in the order in which they are added. Numbers of blocks count up from 1."""

    def __init__(self, name):
        self.name, self.lines, self.blocks = name, [], 0
        units = f"{'kg':>20}{'m':>20}{'s':>20}"
        self.add("#RADIOSS STARTER", "/BEGIN", name, whole(2022) + whole(0), units, units, "/TITLE", name)

    def add(self, *lines):
        self.lines += lines

    def next(self):
        self.blocks += 1
        return self.blocks

    def body(self, nodes, bricks, density, young, poisson):
        """Elastic solids without bulk viscosity: nodes [(number, x)], bricks [(number, eight nodes)]."""
        k = self.next()
        self.add(f"/MAT/ELAST/{k}", f"elastic {k}", number(density), number(young) + number(poisson))
        self.add(f"/PROP/SOLID/{k}", f"solid {k}", whole(24) + whole(4) + 6 * whole(0) + number(1e-20),
                 2 * number(1e-20) + 3 * number(0), number(0) + 2 * whole(0))  # fmt: skip
        self.add(f"/PART/{k}", f"part {k}", whole(k) + whole(k) + whole(0))
        self.add("/NODE", *(whole(n) + "".join(map(number, x)) for n, x in nodes))
        self.add(f"/BRICK/{k}", *("".join(map(whole, [e, *corners])) for e, corners in bricks))
        return self.group([n for n, _ in nodes])

    def group(self, nodes):
        k = self.next()
        rows = ("".join(map(whole, nodes[a : a + 10])) for a in range(0, len(nodes), 10))
        self.add(f"/GRNOD/NODE/{k}", f"group {k}", *rows)
        return k

    def gravity(self, group, g, direction="Z"):
        k = self.next()
        card = whole(0) + f"{direction:>10}" + 2 * whole(0) + whole(group) + " " * 10 + number(1) + number(g)
        self.add(f"/GRAV/{k}", f"gravity {k}", card)

    def velocity(self, group, v):
        k = self.next()
        self.add(f"/INIVEL/TRA/{k}", f"velocity {k}", "".join(map(number, v)) + whole(group) + whole(0))

    def free_node(self, mass, z, speed, gravity=0.0):
        """The first node of the model, beside a soft solid that OpenRadioss asks for."""
        self.add("/NODE", whole(1) + number(0) + number(0) + number(z))
        self.body(*block((1, 1, 1), (1.0, 1.0, 1.0), (10.0, 0.0, 10.0), 11), 1000.0, 1.0, 0.0)
        group = self.group([1])
        self.add(f"/ADMAS/0/{self.next()}", "mass", number(mass) + whole(group))
        if speed:
            self.velocity(group, (0.0, 0.0, speed))
        if gravity:
            self.gravity(group, -gravity)

    def write_files(self, folder, python, stops, step):
        """An engine file for each part of a run, which ends at `stops`."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        starter = [*self.lines, "/FUNCT_PYTHON/1", *python.splitlines(), "/END", ""]
        Path(folder, f"{self.name}_0000.rad").write_text("\n".join(starter))
        for k, stop in enumerate(stops, 1):
            engine = [f"/RUN/{self.name}/{k}", number(stop), "/VERS/2022", "/PRINT/-1", "/TFILE/4", number(stop / 1000)]
            Path(folder, f"{self.name}_{k:04d}.rad").write_text("\n".join([*engine, *step, ""]))

    def write(self, folder, contacts, stop, scale=0.9):
        """scale: of the engine's stable step, which stays that of the solids."""
        self.write_files(folder, PYTHON, [stop], ["/DT", number(scale) + number(0)])
        Path(folder, "ilaw_contacts.py").write_text(f"contacts = {contacts!r}\n")

    def write_window(self, folder, lines, stops, step):
        """Of the user library, at steps of this length."""
        self.add("/USERWI/1", *lines)
        self.write_files(folder, WINDOW, stops, ["/DTIX", 2 * number(step)])


def block(cells, size, corner, first=1):
    """Nodes [(number, x)], x fastest, and bricks of a block, numbered from first on."""
    count = [n + 1 for n in cells]

    def at(a, b, c):
        return first + a + count[0] * (b + count[1] * c)

    steps = [length / n for length, n in zip(size, cells)]
    nodes = [(at(a, b, c), tuple(start + k * d for start, k, d in zip(corner, (a, b, c), steps)))
             for c in range(count[2]) for b in range(count[1]) for a in range(count[0])]  # fmt: skip
    around = ((0, 0), (1, 0), (1, 1), (0, 1))
    bricks = [(first + a + cells[0] * (b + cells[1] * c), [at(a + i, b + j, c + k) for k in (0, 1) for i, j in around])
              for c in range(cells[2]) for b in range(cells[1]) for a in range(cells[0])]  # fmt: skip
    return nodes, bricks


def face(nodes, axis, value):
    """Numbers of the nodes in a plane."""
    return [n for n, x in nodes if abs(x[axis] - value) < 1e-9]


def facets(bricks, nodes):
    """Sides of bricks whose four nodes are all among these, seen counterclockwise from outside."""
    sides = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    chosen = set(nodes)
    return [[b[k] for k in side] for _, b in bricks for side in sides if all(b[k] in chosen for k in side)]
