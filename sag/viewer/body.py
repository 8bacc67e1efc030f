"""A body of capsules around a skeleton: how thick people are, for the eye; figures know bones of one radius only."""

from __future__ import annotations

from typing import NamedTuple

from sag.skeleton import Skeleton

RADII = {
    "head": 0.105, "neck": 0.052, "shoulder": 0.058, "elbow": 0.043, "wrist": 0.033, "spine": 0.098, "chest": 0.108,
    "root": 0.102, "hip": 0.08, "knee": 0.055, "ankle": 0.044,
}  # fmt: skip
"""Metres, by the last word of a joint's name without its number."""

SAMPLE_COLOURS = (
    "#56b4e9", "#e69f00", "#009e73", "#cc79a7", "#f0e442", "#0072b2", "#999933", "#aa4499", "#88ccee",
)  # fmt: skip
"""Of the samples of a window, here and on the viewer's pages: Okabe and Ito's, which hold for the colour-blind, then
three of Tol's."""

USUAL_RADIUS = 0.05
"""Of a joint that has another name, metres."""

FLESH = (("right_shoulder", "right_hip"), ("left_shoulder", "left_hip"))
"""Sides of a trunk, which no bone follows."""


class Link(NamedTuple):
    """A capsule whose ends may differ in size.

    Attributes:
        start: place of a joint.
        end: place of another, or of the same for a ball.
        start_radius: metres.
        end_radius: metres.
        bone: place of the bone that it follows, -1 for flesh.
    """

    start: int
    end: int
    start_radius: float
    end_radius: float
    bone: int


def links_of(skeleton: Skeleton) -> list[Link]:
    """The capsules of a body: one for each bone, a ball for the head, the sides of the trunk."""
    links = []
    for bone, (parent, child) in enumerate(skeleton.bones):
        start, end = skeleton.index(parent, child)
        slim = RADII["neck"] if child == "head" else radius_of(child)
        links.append(Link(start, end, radius_of(parent), slim, bone))
    pairs = [*FLESH, ("head", "head")]
    for parent, child in pairs:
        if parent in skeleton.joints and child in skeleton.joints:
            start, end = skeleton.index(parent, child)
            links.append(Link(start, end, radius_of(parent), radius_of(child), -1))
    return links


def radius_of(joint: str) -> float:
    """How thick a body is about a joint of this name, metres."""
    return RADII.get(joint.rpartition("_")[2].rstrip("0123456789"), USUAL_RADIUS)
