"""Starter and engine of OpenRadioss as a user library sees them: which functions they ask for, and their cycle, for free
nodes under constant forces.

    stub.py EXPORTS LIBRARY start
        reads window.txt, and model.txt, a line per node: user kinematic mass x v force
    stub.py EXPORTS LIBRARY run CYCLES STEP [threads] [no_sync] [no_window]
        goes on from its restart file. Columns of each cycle: time, work of the window before it, x, v.
        threads: each call comes from another one. no_...: a deck that lacks one of the two
"""
# SPDX-License-Identifier: BSD-3-Clause
import ctypes
import os
import sys
import threading

import numpy as np

RESTART = "restart.npz"
STARTER = ("lecg", "lecguser", "lecm", "lecr", "lecm99", "lecsen", "riniuser", "siniusr", "get_userbuf_var")
ENGINE = ("ruser", "sigeps", "sigepsc", "flaw", "flawc", "suser", "userint", "get_uintbuf_var", "user_sens",
          "get_lawc_user_var", "sigeps99c", "set_lawc_user_var", "get_law_user_var", "sigeps99",
          "set_law_user_var")  # fmt: skip
ROOT = np.frombuffer(b"STUB", np.uint8)


def by_address(*values):
    """As Fortran passes numbers and arrays. A number that is changed has to be an array."""
    arrays = [value if isinstance(value, np.ndarray) else np.array([value], np.int32 if isinstance(value, int) else float)
              for value in values]  # fmt: skip
    return arrays, [ctypes.c_void_p(array.ctypes.data) for array in arrays]


def call(function, *values):
    kept, addresses = by_address(*values)
    function.restype = None
    function(*addresses)
    del kept


def start(library):
    for name in STARTER:
        getattr(library, f"st_{name}_")
    rows = np.loadtxt("model.txt", ndmin=2)
    user, kinematic = np.array(rows[:, :2].T, np.int32)
    mass, x, v, force = (np.ascontiguousarray(rows[:, part]) for part in (2, slice(3, 6), slice(6, 9), slice(9, 12)))
    with open("window.txt") as lines, open("SISTUB_0001.scr", "w") as deck:
        deck.write("/USERWI\n" + lines.read())
    numbers, integers, spin = np.zeros(1, np.int32), np.zeros(1, np.int32), np.zeros_like(x)
    model = len(user), user, x, v, spin, mass, 0 * mass, numbers, integers
    call(library.st_userwis_ini_, ROOT, len(ROOT), np.zeros(100, np.int32), *model)
    memory, text = np.zeros(numbers[0]), np.zeros(integers[0] + 100, np.int32)
    call(library.st_userwis_, ROOT, len(ROOT), *model, memory, text)
    np.savez(RESTART, user=user, kinematic=kinematic, mass=mass, x=x, v=v, d=0 * x, force=force, memory=memory, text=text,
             cycle=np.zeros(1, np.int32), time=0.0, last_step=0.0, work=np.zeros(1))  # fmt: skip


class Engine:
    def __init__(self, library, options):
        for name in ENGINE:
            getattr(library, f"eng_{name}_")
        self.window_of, self.sync_of, self.options = library.eng_userwi_, library.ilaw_openradioss_sync, options
        self.sync_of.restype = None
        self.model = dict(np.load(RESTART))

    def run(self, cycles, length):
        m = self.model
        self.sync(float(m["last_step"]))  # as the engine does before its first cycle
        for _ in range(cycles):
            self.window()
            step = length * (1.0, 0.9, 0.8, 0.9)[int(m["cycle"][0]) % 4]
            m["v"] += 0.5 * (m["last_step"] + step) * m["force"] / m["mass"][:, None]
            m["x"] += step * m["v"]
            m["d"] += step * m["v"]
            m["time"], m["last_step"] = m["time"] + step, np.float64(step)
            m["cycle"] += 1
            self.sync(step)
            print(*(repr(float(number)) for number in (m["time"], m["work"][0], *m["x"].ravel(), *m["v"].ravel())))
        np.savez(RESTART, **m)

    def beside(self, function):
        if "threads" not in self.options:
            return function()
        thread = threading.Thread(target=function)
        thread.start()
        thread.join()

    def sync(self, step):
        if "no_sync" in self.options:
            return
        m = self.model
        _, arrays = by_address(*(m[name] for name in ("user", "kinematic", "x", "v", "d", "mass")))
        numbers = ctypes.c_double(m["time"]), ctypes.c_double(step), ctypes.c_long(len(m["user"]))
        self.beside(lambda: self.sync_of(*numbers, *arrays))

    def window(self):
        """With the first node of the window, in copies of its values."""
        if "no_window" in self.options:
            return
        m, zero = self.model, np.zeros(3)
        x, v, a, moment, every = m["x"][0].copy(), m["v"][0].copy(), np.zeros(3), np.zeros(3), np.zeros_like(m["x"])
        self.beside(lambda: call(
            self.window_of, ROOT, len(ROOT), len(m["memory"]), 0, 1, m["cycle"], 1, m["text"], int(m["user"][0]),
            float(m["time"]), float(m["last_step"]), np.array([1e30]), np.zeros(1), m["work"], m["memory"], zero, x, v, zero,
            m["mass"], zero, zero, zero, a, moment, every))  # fmt: skip


def main(exports, path, what, *words):
    ctypes.CDLL(exports, mode=os.RTLD_GLOBAL)
    library = ctypes.CDLL(path, mode=os.RTLD_GLOBAL | os.RTLD_DEEPBIND)
    version = np.zeros(1, np.int32)
    call(library.userlib_id, version)
    if version[0] != 1:
        sys.exit("found another version")
    if what == "start":
        start(library)
    else:
        Engine(library, words[2:]).run(int(words[0]), float(words[1]))


if __name__ == "__main__":
    main(*sys.argv[1:])
