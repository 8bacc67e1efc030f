"""What a skeleton is: a tree of named joints, and the groups that make its graph levels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from sag.errors import SagError
from sag.skeleton.levels import Groups, Level

FEET = ("right_ankle", "left_ankle")
"""Joints that every skeleton must have, by these names."""


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
        path: the file that tells it; none for those of `SKELETONS`.
    """

    name: str
    joints: tuple[str, ...]
    bones: tuple[tuple[str, str], ...]
    root: str
    parts: Groups
    limbs: Groups
    path: Path | None = None

    def __post_init__(self) -> None:
        if len(set(self.joints)) < len(self.joints):
            raise SagError(f"skeleton {self.name} names a joint twice")
        if missing := [name for name in FEET if name not in self.joints]:
            lacking = " and no ".join(missing)
            raise SagError(f"skeleton {self.name} has no joint {lacking}, where feet are measured: name its own so")
        self._check_tree()
        for groups, members in ((self.parts, self.joints), (self.limbs, tuple(self.parts))):
            found = sorted(m for group in groups.values() for m in group)
            if found != sorted(members):
                differing = sorted({*found} ^ {*members} or {m for m in found if found.count(m) > 1})
                said = f"groups {_few(groups)} must hold each of {_few(members)} once, unlike {_few(differing)}"
                raise SagError(f"skeleton {self.name}: {said}")

    def _check_tree(self) -> None:
        reached = [self.root]
        for parent, child in self.bones:
            if parent not in reached or child in reached:
                raise SagError(
                    f"skeleton {self.name}: the bone from {parent} to {child} must come after the one that leads to "
                    f"{parent} from the root {self.root}, and no other may lead to {child}"
                )
            reached.append(child)
        if sorted(reached) != sorted(self.joints):
            differing = sorted({*reached} ^ {*self.joints})
            said = f"bones must lead from the root to all joints, unlike {_few(differing)}"
            raise SagError(f"skeleton {self.name}: {said}")

    @property
    def reference(self) -> str:
        """What configs call it: its name, or the path of its file."""
        return str(self.path or self.name)

    @property
    def description(self) -> dict[str, Any]:
        """Everything about it in plain lists, as its file tells it."""
        groups = {level: {k: list(v) for k, v in getattr(self, level).items()} for level in ("parts", "limbs")}
        bones = [list(bone) for bone in self.bones]
        return {"name": self.name, "joints": list(self.joints), "bones": bones, "root": self.root, **groups}

    @property
    def root_index(self) -> int:
        """Place of the root among the joints."""
        return self.joints.index(self.root)

    def index(self, *names: str) -> list[int]:
        """Places of the named joints."""
        return [self.joints.index(name) for name in names]

    @property
    def feet(self) -> list[int]:
        """Places of the ankles, where feet are measured: the right one, the left one."""
        return self.index(*FEET)

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
        joints = Level.of_tree(self.joints, self.bone_index)
        parts = joints.grouped(self.parts)
        limbs = parts.grouped(self.limbs)
        return joints, parts, limbs, limbs.grouped({"body": limbs.nodes})


def _few(names: Iterable[str]) -> str:
    """The first few of some names; a file may tell hundreds."""
    first = list(names)
    return ", ".join(first[:8]) + (f" and {len(first) - 8} more" if len(first) > 8 else "")
