"""Two threads as ranks that solve one problem of coupled contacts."""
import threading

import numpy as np


def on_two_ranks(count, solve, first=(0, 0)):
    """What solve(rank, exchange) returns on each; first: the body that a rank has first, the others behind it in turn."""
    barrier, table, found = threading.Barrier(2, timeout=20), [None, None], [None, None]

    class Threads:
        def __init__(self, rank):
            self.rank = rank

        def combine(self, values, by, shift=0):
            table[self.rank] = np.roll(values, shift, axis=0)
            barrier.wait()
            values[...] = np.roll(by(table[0], table[1]), -shift, axis=0)
            barrier.wait()

        def sum_bodies(self, values):
            assert values.ndim == 2 and len(values) == count
            self.combine(values, np.add, first[self.rank])

        def largest(self, values):
            self.combine(values, np.maximum)

        def sum(self, values):
            self.combine(values, np.add)

    def run(rank):
        found[rank] = solve(rank, Threads(rank))

    threads = [threading.Thread(target=run, args=(rank,)) for rank in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found
