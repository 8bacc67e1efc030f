"""Whether joints are a person of plausible size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sag.data.check.report import Line, graded
from sag.skeleton import Skeleton

STATURE = (0.9, 2.3)
"""Plausible ways from the head along the bones to an ankle, metres."""

TREMBLE = 0.02
"""A bone whose length strays farther than this (metres) is worth a look."""


@dataclass(frozen=True)
class Bones:
    """Lengths of the bones of one recording, metres.

    Attributes:
        shortest: median length of the shortest bone.
        longest: median length of the longest.
        stature: way from the head along the bones to the right ankle.
        stray: farthest that any bone is from its median length in any frame.
    """

    shortest: float
    longest: float
    stature: float
    stray: float

    @property
    def plausible(self) -> bool:
        """Whether they are a person's, in metres."""
        return STATURE[0] <= self.stature <= STATURE[1]


def way_between(skeleton: Skeleton, start: str, end: str) -> list[int]:
    """Places of the joints along the bones from one joint to another."""
    parent = {child: parent for parent, child in skeleton.bones}

    def upwards(joint: str) -> list[str]:
        return [joint, *(upwards(parent[joint]) if joint in parent else [])]

    up, down = upwards(start), upwards(end)
    shared = next(joint for joint in up if joint in down)
    return skeleton.index(*up[: up.index(shared)], *reversed(down[: down.index(shared) + 1]))


def bones_of(joints: Float[np.ndarray, "t j 3"], limbs: Int[np.ndarray, "bones 2"], way: list[int]) -> Bones | None:
    """Bone lengths of a recording; nothing where no frame has all joints.

    Args:
        joints: metres, any frame; not numbers where one is missing.
        limbs: places of both ends of each bone.
        way: joints from the head along the bones to an ankle.
    """
    whole = joints[np.isfinite(joints).all(axis=(1, 2))]
    if not len(whole):
        return None
    lengths = np.linalg.norm(whole[:, limbs[:, 0]] - whole[:, limbs[:, 1]], axis=-1)
    medians = np.median(lengths, axis=0)
    steps = np.linalg.norm(np.diff(whole[:, way], axis=1), axis=-1)
    stray = float(np.abs(lengths - medians).max())
    return Bones(float(medians.min()), float(medians.max()), float(np.median(steps.sum(axis=1))), stray)


def _units(stature: float) -> str:
    """Which units would make a person of a way from head to ankle that no person has."""
    for unit, count in {"centimetres": 100, "millimetres": 1000}.items():
        if STATURE[0] <= stature / count <= STATURE[1]:
            return f", as if joints were in {unit}: divide them by {count}"
    return ""


def bones_line(known: Sequence[tuple[str, Bones]]) -> Line:
    """What to think of the bones of recordings, by name."""
    if not known:
        return Line("bones", "no frame has all joints", "look")
    unlikely = [(name, bones.stature) for name, bones in known if not bones.plausible]
    wrong = tuple(f"{name}: {stature:.4g} m{_units(stature)}" for name, stature in unlikely)
    low, high = (choice(bones.stature for _, bones in known) for choice in (min, max))
    stray = max(bones.stray for _, bones in known)
    span = f"{low:.2f}" if f"{low:.2f}" == f"{high:.2f}" else f"{low:.2f} to {high:.2f}"
    value = f"{span} m from head to ankle; no bone's length changes by more than {1000 * stray:.2g} mm"
    return Line("bones", value, "broken" if wrong else graded(stray, TREMBLE, np.inf), wrong)
