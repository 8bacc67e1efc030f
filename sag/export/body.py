"""A body of capsules in the rest pose, and the nodes that carry it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from jaxtyping import Float, Int

from sag.export.rig import Rig
from sag.geometry.kinematics import unit
from sag.skeleton import Skeleton
from sag.viewer.body import RADII, radius_of

AROUND = 16
"""Sides of a tube."""


@dataclass(frozen=True, eq=False)
class Body:
    """A mesh whose every vertex is carried by one node; metres, rest pose.

    Attributes:
        vertices: places.
        normals: of length 1, outward.
        triangles: vertices of each, counter-clockwise from outside.
        nodes: of the rig `with_ends`, the one that carries each vertex.
    """

    vertices: Float[np.ndarray, "v 3"]
    normals: Float[np.ndarray, "v 3"]
    triangles: Int[np.ndarray, "f 3"]
    nodes: Int[np.ndarray, " v"]


def bone_nodes(rig: Rig) -> list[int]:
    """Nodes at the far ends of bones: those that do not stand at the joint of their parent."""
    return [n for n, parent in enumerate(rig.parents.tolist()) if parent >= 0 and rig.joints[parent] != rig.joints[n]]


def with_ends(rig: Rig) -> Rig:
    """The rig with one more node for each of `bone_nodes`, in their order: there too, but turning with the bone.

    They carry the far ends of the tubes, which so keep their shape where joints bend and bones stretch.
    """
    bones = bone_nodes(rig)
    return Rig(
        (*rig.names, *(f"{rig.names[node]}_end" for node in bones)),
        np.concatenate([rig.parents, rig.parents[bones]]),
        np.concatenate([rig.joints, rig.joints[bones]]),
        np.concatenate([rig.offsets, rig.offsets[bones]]),
    )


def rest_places(rig: Rig) -> Float[np.ndarray, "n 3"]:
    """Places of the nodes in the rest pose, metres; the root at the origin."""
    places = np.zeros((len(rig.names), 3))
    for node, parent in enumerate(rig.parents.tolist()):
        if parent >= 0:
            places[node] = places[parent] + rig.offsets[node]
    return places


def body_of(rig: Rig, skeleton: Skeleton) -> Body:
    """A ball at every joint and a tube along every bone, as thick as people are there.

    Args:
        rig: before `with_ends`.
        skeleton: whose joints and bones they are.
    """
    places = rest_places(rig)
    radii = [radius_of(skeleton.joints[joint]) for joint in rig.joints.tolist()]
    joints = [node for node, name in enumerate(rig.names) if name in skeleton.joints]
    parts = [_ball(places[node], radii[node], node) for node in joints]
    for turn, node in enumerate(bone_nodes(rig)):
        start = int(rig.parents[node])
        thick = radii[start], RADII["neck"] if rig.names[node] == "head" else radii[node]
        parts.append(_tube(places[[start, node]], thick, (start, len(rig.names) + turn)))
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Body(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.triangles + first for part, first in zip(parts, firsts.tolist())]),
        np.concatenate([part.nodes for part in parts]),
    )


def _ball(centre: np.ndarray, radius: float, node: int) -> Body:
    ball = trimesh.creation.icosphere(subdivisions=2)
    directions = np.asarray(ball.vertices)
    return Body(centre + radius * directions, directions, np.asarray(ball.faces), np.full(len(directions), node))


def _tube(ends: np.ndarray, radii: tuple[float, float], nodes: tuple[int, int]) -> Body:
    """An open tube whose ends may differ in size; each is carried by a node of its own."""
    along = unit(ends[1] - ends[0])
    aside = unit(np.cross(along, np.eye(3)[np.argmin(np.abs(along))]))
    angles = 2 * np.pi * np.arange(AROUND)[:, None] / AROUND
    ring = np.cos(angles) * aside + np.sin(angles) * np.cross(along, aside)
    here = np.arange(AROUND)
    there = np.roll(here, -1)
    triangles = np.concatenate(
        [np.stack([here, there, here + AROUND], 1), np.stack([there, there + AROUND, here + AROUND], 1)]
    )
    vertices = np.concatenate([end + radius * ring for end, radius in zip(ends, radii)])
    return Body(vertices, np.concatenate([ring, ring]), triangles, np.repeat(nodes, AROUND))
