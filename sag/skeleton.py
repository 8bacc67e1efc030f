"""Skeletons as values: joints, bones, left and right, and the graph levels of the networks.

A level groups the nodes of the level below it by name, so any skeleton gets its levels from named
groups: joints -> parts -> limbs -> body (19 -> 11 -> 5 -> 1 in the paper's Tables 7, 8 and 11).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from sag.errors import SagError

Groups = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree of named joints with the groups that make its graph levels.

    Attributes:
        name: what configs call it.
        joints: names in the order of the arrays; left and right are the person's own.
        bones: (parent, child) pairs, each after the one that leads to its parent.
        root: the joint that the trajectory follows.
        parts: groups of joints, the second level.
        limbs: groups of parts, the third level.
    """

    name: str
    joints: tuple[str, ...]
    bones: tuple[tuple[str, str], ...]
    root: str
    parts: Groups
    limbs: Groups

    def __post_init__(self) -> None:
        for groups, members in ((self.parts, self.joints), (self.limbs, tuple(self.parts))):
            found = sorted(m for group in groups.values() for m in group)
            if found != sorted(members):
                raise SagError(f"skeleton {self.name}: groups {list(groups)} must hold each of {members} once")

    @property
    def root_index(self) -> int:
        """Place of the root among the joints."""
        return self.joints.index(self.root)

    def index(self, *names: str) -> list[int]:
        """Places of the named joints."""
        return [self.joints.index(name) for name in names]

    @cached_property
    def bone_index(self) -> np.ndarray:
        """(bones, 2) places of parent and child."""
        return np.array([self.index(parent, child) for parent, child in self.bones])

    @cached_property
    def mirror(self) -> tuple[int, ...]:
        """The joint on the other side, itself for those in the middle."""

        def other(name: str) -> str:
            side, _, rest = name.partition("_")
            return {"left": f"right_{rest}", "right": f"left_{rest}"}.get(side, name)

        return tuple(self.joints.index(other(name)) for name in self.joints)

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Graph levels from fine to coarse: joints, parts, limbs, body."""
        joints = Level.of_tree(self)
        parts = joints.grouped(self.parts)
        limbs = parts.grouped(self.limbs)
        return joints, parts, limbs, limbs.grouped({"body": limbs.nodes})


@dataclass(frozen=True, eq=False)
class Level:
    """One graph level.

    Attributes:
        nodes: names.
        members: (joints, nodes) 1 where a joint belongs to a node.
        adjacency: (nodes, nodes) 1 where nodes touch, without the diagonal.
        distance: (nodes,) bones between the root and the nearest joint of a node.
    """

    nodes: tuple[str, ...]
    members: Float[np.ndarray, "joints nodes"]
    adjacency: Float[np.ndarray, "nodes nodes"]
    distance: Float[np.ndarray, " nodes"]

    @classmethod
    def of_tree(cls, skeleton: Skeleton) -> Level:
        """The finest level: a node for each joint."""
        count = len(skeleton.joints)
        adjacency = np.zeros((count, count))
        distance = np.zeros(count)
        for parent, child in skeleton.bone_index:
            adjacency[parent, child] = adjacency[child, parent] = 1
            distance[child] = distance[parent] + 1
        return cls(skeleton.joints, np.eye(count), adjacency, distance)

    def grouped(self, groups: Groups) -> Level:
        """The next coarser level: a node for each named group of this level's nodes."""
        inside = np.array([[float(n in group) for group in groups.values()] for n in self.nodes])
        touching = (inside.T @ self.adjacency @ inside > 0) & ~np.eye(len(groups), dtype=bool)
        distance = np.array([self.distance[inside[:, g] > 0].min() for g in range(len(groups))])
        return Level(tuple(groups), self.members @ inside, touching.astype(float), distance)

    def shared(self, other: Level) -> Float[np.ndarray, "nodes others"]:
        """1 where a node of this level and one of another have a joint in common."""
        return (self.members.T @ other.members > 0).astype(float)


def _sides(*names: str) -> tuple[str, ...]:
    return tuple(f"{side}_{name}" for side in ("right", "left") for name in names)


def _limb_bones(neck: str, root: str) -> tuple[tuple[str, str], ...]:
    arms = [(neck, "shoulder"), ("shoulder", "elbow"), ("elbow", "wrist")]
    legs = [(root, "hip"), ("hip", "knee"), ("knee", "ankle")]
    middle = (neck, root)
    return tuple(
        (a if a in middle else f"{side}_{a}", f"{side}_{b}")
        for chain in (arms, legs)
        for side in ("right", "left")
        for a, b in chain
    )


_LIMB_PARTS: Groups = {
    f"{side}_{end}": tuple(f"{side}_{n}" for n in names)
    for side in ("right", "left")
    for end, names in {
        "elbow": ("shoulder", "elbow"),
        "wrist": ("wrist",),
        "knee": ("hip", "knee"),
        "ankle": ("ankle",),
    }.items()
}

_LIMBS: Groups = {
    "torso": ("head", "neck", "root"),
    **{f"{s}_arm": (f"{s}_elbow", f"{s}_wrist") for s in ("right", "left")},
    **{f"{s}_leg": (f"{s}_knee", f"{s}_ankle") for s in ("right", "left")},
}

_SPINE = ("spine0", "spine1", "spine2", "spine3", "root")

GTA_IM_19 = Skeleton(
    name="gta_im_19",
    joints=("head", "neck", *_sides("shoulder", "elbow", "wrist"), *_SPINE, *_sides("hip", "knee", "ankle")),
    bones=(
        *tuple(zip(_SPINE[:0:-1], _SPINE[-2::-1])),
        ("spine0", "neck"),
        ("neck", "head"),
        *_limb_bones("neck", "root"),
    ),
    root="root",
    parts={
        "head": ("head",),
        "neck": ("neck", "spine0", "spine1"),
        "root": ("spine2", "spine3", "root"),
        **_LIMB_PARTS,
    },
    limbs=_LIMBS,
)
"""GTA-IM's 21 joints less the clavicles; the root is the lowest of its spine joints (spine4 there)."""

PROX_16 = Skeleton(
    name="prox_16",
    joints=(
        "head", "neck", *_sides("shoulder", "elbow", "wrist"), "chest", "root", *_sides("hip", "knee", "ankle"),
    ),
    bones=(("root", "chest"), ("chest", "neck"), ("neck", "head"), *_limb_bones("neck", "root")),
    root="root",
    parts={"head": ("head",), "neck": ("neck", "chest"), "root": ("root",), **_LIMB_PARTS},
    limbs=_LIMBS,
)  # fmt: skip
"""16 joints of SMPL-X that GTA-IM has too."""

SKELETONS: dict[str, Skeleton] = {s.name: s for s in (GTA_IM_19, PROX_16)}
"""Every skeleton a config can name."""


def skeleton_named(name: str) -> Skeleton:
    """The skeleton of that name.

    Raises:
        SagError: no skeleton has this name.
    """
    if name not in SKELETONS:
        raise SagError(f"no skeleton is called {name!r}; known are {', '.join(SKELETONS)}")
    return SKELETONS[name]
