"""Levels of a skeleton's graph, from fine to coarse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

Groups = Mapping[str, tuple[str, ...]]
"""Names of groups with the names of what is in each."""


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
    def of_tree(cls, joints: tuple[str, ...], bones: Int[np.ndarray, "bones 2"]) -> Level:
        """The finest level: a node for each joint, given the places of each bone's parent and child."""
        count = len(joints)
        adjacency = np.zeros((count, count))
        distance = np.zeros(count)
        for parent, child in bones:
            adjacency[parent, child] = adjacency[child, parent] = 1
            distance[child] = distance[parent] + 1
        return cls(joints, np.eye(count), adjacency, distance)

    def grouped(self, groups: Groups) -> Level:
        """The next coarser level: a node for each named group of this level's nodes."""
        inside = np.array([[float(n in group) for group in groups.values()] for n in self.nodes])
        touching = (inside.T @ self.adjacency @ inside > 0) & ~np.eye(len(groups), dtype=bool)
        distance = np.array([self.distance[inside[:, g] > 0].min() for g in range(len(groups))])
        return Level(tuple(groups), self.members @ inside, touching.astype(float), distance)

    def shared(self, other: Level) -> Float[np.ndarray, "nodes others"]:
        """1 where a node of this level and one of another have a joint in common."""
        return (self.members.T @ other.members > 0).astype(float)
