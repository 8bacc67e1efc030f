"""Skeletons as values: joints, bones, left and right, and the graph levels of the networks.

A level groups the nodes of the level below it by name, so any skeleton gets its levels from named
groups: joints -> parts -> limbs -> body (19 -> 11 -> 5 -> 1 in the paper's Tables 7, 8 and 11).
"""

from sag.skeleton.known import GTA_IM_19, PROX_16, SKELETONS
from sag.skeleton.levels import Groups, Level
from sag.skeleton.named import read_skeleton, skeleton_named
from sag.skeleton.tree import Skeleton

__all__ = ["GTA_IM_19", "PROX_16", "SKELETONS", "Groups", "Level", "Skeleton", "read_skeleton", "skeleton_named"]
