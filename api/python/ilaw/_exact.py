"""Solutions in closed form of some scenes, to measure errors against. Derivations: the `doc` of each scene."""
# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from typing import Callable, Optional

from ._command import BadInput
from ._exact_bars import bar_on_wall, bouncing_bar, glued_bar, held_rod, two_bars
from ._exact_points import bouncing_ball, impact_oscillator, oblique_impact
from ._exact_postit import postit_point
from ._motions import Case, Exact, Scene, require

# The solution of each name, and the scene that it is of: its kind of model and its bodies, then in words.
ONE_POINT = ("points", 1)
ONE_BAR = ("bars", 1)
SOLUTIONS: dict[str, tuple[Callable[[Case, str], Exact], tuple[str, int], str]] = {
    "bouncing_ball": (bouncing_ball, ONE_POINT, "one point at rest in 1D under gravity, above a plane, with law 'contact'"),
    "impact_oscillator": (impact_oscillator, ONE_POINT,
                          "one point in 1D on a spring, thrown above a plane, without loads, with law 'contact'"),
    "oblique_impact": (oblique_impact, ONE_POINT,
                       "one point in 2D that is thrown along a plane with normal [0, 1], under gravity, with law "
                       "'coulomb', friction and a restitution below 1"),
    "postit_point": (postit_point, ONE_POINT,
                     "one point at rest in 1D on a plane, with law 'postit', brittle rupture, shocks, and forces that pull"),
    "bar_on_wall": (bar_on_wall, ONE_BAR, "one bar that flies against a plane, no loads"),
    "bouncing_bar": (bouncing_bar, ONE_BAR, "one bar at rest, undeformed and under gravity, above a plane"),
    "held_rod": (held_rod, ONE_BAR,
                 "one bar at rest, stretched away from a plane at its left end, its right end held, no other load"),
    "glued_bar": (glued_bar, ONE_BAR, "one bar, glued on the left by law 'postit' with initial_adhesion and memory, "
                  "pulled at its right end by a constant force"),
    "two_bars": (two_bars, ("bars", 2), "two bars, no loads, and both ends watched, that of the right bar first"),
}  # fmt: skip


# Keys that solutions read, or that change no motion.
COVERED = {
    "scene": "title doc units sets model time initial loads interfaces output exact converge study expect",
    "points": "mass position velocity stiffness area",
    "bars": "name start length elements young density section velocity",
    "interface": "name law library parameters nodes obstacle against skip",
    "obstacle": "type point normal", "against": "nodes normal",
    "gravity": "type name acceleration", "force": "type name nodes direction history",
    "shock": "type name nodes time impulse", "motion": "type name nodes", "bulk_viscosity": "type name linear quadratic",
}  # fmt: skip


def check_keys(scene: Scene, name: str, kind: str) -> None:
    """Refuses a key that may change the motion and that no solution knows."""
    parts = [("scene", "", scene)]
    parts += [(kind, f"/model/{kind}/{k}", body) for k, body in enumerate(scene["model"][kind])]
    parts += [(load["type"], f"/loads/{k}", load) for k, load in enumerate(scene.get("loads", []))]
    for k, interface in enumerate(scene["interfaces"]):
        parts += [("interface", f"/interfaces/{k}", interface)]
        parts += [(key, f"/interfaces/{k}/{key}", interface[key]) for key in ("obstacle", "against") if key in interface]
    for what, pointer, part in parts:
        springs = {"stiffness"} if name != "impact_oscillator" else set()
        for key in sorted(part.keys() - (set(COVERED[what].split()) - springs)):
            raise BadInput(f"{pointer}/{key}: found a key that the closed form '{name}' does not know, expected none")


def exact_solution(scene: Scene, watched: int, steps: int, dt: float) -> Optional[Exact]:
    """None if the scene names none; refuses a scene that the named solution does not cover."""
    if "exact" not in scene:
        return None
    name = scene["exact"]["type"]
    solution, (kind, bodies), wanted = SOLUTIONS[name]
    require("springs" not in scene, "a scene without 'springs'")
    require(name == "held_rod" or "initial" not in scene, "a scene without 'initial'")
    turns = any(key in interface.get("obstacle", {}) for interface in scene["interfaces"] for key in ("rate", "angles"))
    require(not turns, "obstacles that do not turn")
    loads = [load for load in scene.get("loads", []) if load["type"] != "bulk_viscosity"]
    if name == "two_bars":
        require(watched == 2 and not scene.get("loads"), wanted)
    else:
        require(watched == 1, "one watched node, the one in contact")
    model = scene["model"]
    require(model["type"] == kind and len(model[kind]) == bodies, wanted)
    try:
        exact = solution(Case(scene, model[kind][0], scene["interfaces"][0], loads, dt * steps, dt), wanted)
        check_keys(scene, name, kind)
        return exact
    except (KeyError, IndexError, TypeError, ValueError):  # a key is missing that the solution needs
        raise BadInput(f"/exact: expected {wanted}") from None
