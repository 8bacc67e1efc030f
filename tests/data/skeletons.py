"""Skeletons that tests of several data sets use."""

from __future__ import annotations

from dataclasses import replace

from sag.skeleton import PROX_16, Skeleton


def chest_rooted() -> Skeleton:
    """The joints of `prox_16`, with another root."""
    bones = tuple(("chest", "root") if bone == ("root", "chest") else bone for bone in PROX_16.bones)
    return replace(PROX_16, name="chest_rooted", root="chest", bones=bones)
