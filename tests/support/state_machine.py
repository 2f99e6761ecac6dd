"""Drawn sequences of actions against a model of what they must do, and the shortest one that fails."""
import random


class Broken(AssertionError):
    """What is not as the model says."""


def demand(condition, *what):
    if not condition:
        raise Broken(" ".join(map(str, what)))


def simpler(actions, plainer):
    """Sequences with less in them, the shortest first; plainer: simpler forms of an action."""
    for size in (len(actions) // 2, len(actions) // 4, 1):
        for k in range(0, len(actions), max(size, 1)):
            yield actions[:k] + actions[k + max(size, 1):]
    for k, action in enumerate(actions):
        for plain in plainer(action):
            if plain != action:
                yield [*actions[:k], plain, *actions[k + 1:]]


def shrunk(actions, fails, plainer):
    while True:
        less = next((fewer for fewer in simpler(actions, plainer) if fails(fewer)), None)
        if less is None:
            return actions
        actions = less


def search(seed, count, drawn, failure_of, plainer):
    """The shortest sequence that fails and why, or two times nothing. drawn: makes a sequence of a random.Random;
    failure_of: the text of what fails in one, empty where nothing does."""
    draw = random.Random(seed)
    for _ in range(count):
        actions = drawn(draw)
        if failure_of(actions):
            short = shrunk(actions, failure_of, plainer)
            return short, failure_of(short)
    return [], ""
