"""The nodes that animation formats turn: a skeleton in the shape of a T, and what brings it into each frame.

The rest pose is the one that programs expect: Y up, the person upright and facing +Z with the arms held out, so that
the person's left is +X.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sag.export.rotations import turning
from sag.geometry.kinematics import unit
from sag.skeleton import Skeleton

UP, FORWARD, LEFT = np.array([0.0, 1, 0]), np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
"""Of a person in the rest pose."""

SHORTEST = 1e-4
"""Least length of a bone in the rest pose, metres: programs drop bones without length."""


@dataclass(frozen=True, eq=False)
class Rig:
    """Nodes in their rest pose, each after its parent, the first child's before the second child's.

    Attributes:
        names: joints by their own names; a node that only turns one of several bones is called `parent_to_child`.
        parents: place of each node's parent, -1 at the root.
        joints: place in the skeleton of the joint at which a node stands.
        offsets: from the parent in the rest pose, metres, Y up.
    """

    names: tuple[str, ...]
    parents: Int[np.ndarray, " n"]
    joints: Int[np.ndarray, " n"]
    offsets: Float[np.ndarray, "n 3"]

    def children(self, node: int) -> list[int]:
        """Places of a node's children."""
        return np.flatnonzero(self.parents == node).tolist()

    def turns(self, node: int) -> list[int]:
        """A node at the far end of each bone that a node turns; bones behind nodes at the same joint are among them."""
        found: dict[int, int] = {}
        for child in self.children(node):
            ends = self.turns(child) if self.joints[child] == self.joints[node] else [child]
            for end in ends:
                found.setdefault(int(self.joints[end]), end)
        return list(found.values())

    def rotations(self, joints: Float[np.ndarray, "t j 3"]) -> Float[np.ndarray, "t n 3 3"]:
        """Turn of every node against its parent that leads its bones from the rest pose to the joints of each frame.

        Args:
            joints: metres, Y up.
        """
        local = np.empty((len(joints), len(self.names), 3, 3))
        whole = np.empty_like(local)
        for node, parent in enumerate(self.parents.tolist()):
            above = whole[:, parent] if parent >= 0 else np.eye(3)
            ends = self.turns(node)
            bones = joints[:, self.joints[ends]] - joints[:, self.joints[[node]]]
            local[:, node] = turning(unit(self.offsets[ends]), unit(bones) @ above)
            whole[:, node] = above @ local[:, node]
        return local

    def whole_turns(self, local: Float[np.ndarray, "t n 3 3"]) -> Float[np.ndarray, "t n 3 3"]:
        """Turn of every node against the world, from those against the parents."""
        whole = np.array(local)
        for node, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                whole[:, node] = whole[:, parent] @ local[:, node]
        return whole

    def steps(
        self, joints: Float[np.ndarray, "t j 3"], local: Float[np.ndarray, "t n 3 3"]
    ) -> Float[np.ndarray, "t n 3"]:
        """Way from the parent to each node, metres in the parent's axes; at the root its place in the world."""
        whole, places = self.whole_turns(local), joints[:, self.joints]
        ways = np.einsum("tnji,tnj->tni", whole[:, self.parents], places - places[:, self.parents])
        return np.where((self.parents < 0)[:, None], places, ways)

    def posed(
        self, steps: Float[np.ndarray, "t n 3"], local: Float[np.ndarray, "t n 3 3"]
    ) -> Float[np.ndarray, "t n 3"]:
        """Places of all nodes, metres, from the ways to them and the turns of their parents."""
        whole, places = self.whole_turns(local), np.array(steps)
        for node, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                places[:, node] = places[:, parent] + (whole[:, parent] @ steps[:, node, :, None])[..., 0]
        return places

    def rigid_steps(self, joints: Float[np.ndarray, "t j 3"]) -> Float[np.ndarray, "t n 3"]:
        """Ways from the parents where no bone changes its length: those of the rest pose, and the root's places."""
        places = joints[:, self.joints]
        return np.where((self.parents < 0)[:, None], places, self.offsets)


def rig_of(skeleton: Skeleton, lengths: Float[np.ndarray, " bones"], split: bool) -> Rig:
    """The skeleton in the shape of a T.

    Args:
        skeleton: whose joints are the nodes.
        lengths: of its bones, metres.
        split: gives each of several bones that begin at one joint a node of its own there, which turns it alone.
    """
    names: list[str] = []
    parents: list[int] = []
    places: list[int] = []
    offsets: list[np.ndarray] = []

    def add(name: str, parent: int, joint: str, offset: np.ndarray) -> int:
        names.append(name)
        parents.append(parent)
        places.append(skeleton.joints.index(joint))
        offsets.append(offset)
        return len(names) - 1

    def grow(joint: str, parent: int, offset: np.ndarray) -> None:
        node = add(joint, parent, joint, offset)
        bones = [(place, child) for place, (start, child) in enumerate(skeleton.bones) if start == joint]
        for place, child in bones:
            begin = add(f"{joint}_to_{child}", node, joint, np.zeros(3)) if split and len(bones) > 1 else node
            grow(child, begin, rest_direction(skeleton, joint, child) * max(float(lengths[place]), SHORTEST))

    grow(skeleton.root, -1, np.zeros(3))
    return Rig(tuple(names), np.array(parents), np.array(places), np.array(offsets))


def rest_direction(skeleton: Skeleton, parent: str, child: str) -> Float[np.ndarray, 3]:
    """Where a bone points in the rest pose: legs down, arms and hips aside, feet forward, all else up.

    Args:
        skeleton: whose bone it is.
        parent: joint at its start.
        child: joint at its end.
    """
    above = {end: start for start, end in skeleton.bones}
    feet = [skeleton.joints[place] for place in skeleton.feet]
    if any(foot in _way_up(above, parent) for foot in feet):
        return FORWARD
    sides = [{"left": 1, "right": -1}.get(name.partition("_")[0], 0) for name in (parent, child)]
    if any(child in _way_up(above, foot) for foot in feet) and (sides[0] or not sides[1]):
        return -UP
    return sides[1] * LEFT if sides[1] else UP


def _way_up(above: dict[str, str], joint: str) -> list[str]:
    """A joint and those between it and the root."""
    return [joint, *(_way_up(above, above[joint]) if joint in above else [])]


def median_lengths(joints: Float[np.ndarray, "t j 3"], skeleton: Skeleton) -> Float[np.ndarray, " bones"]:
    """Median over the frames of the length of every bone, metres."""
    starts, ends = skeleton.bone_index.T
    return np.asarray(np.median(np.linalg.norm(joints[:, ends] - joints[:, starts], axis=-1), axis=0))
