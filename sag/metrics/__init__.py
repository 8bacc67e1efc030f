"""Metrics of human motion in scenes: functions and torchmetrics classes."""

from sag.geometry.capsule import points_in_capsules
from sag.metrics.collisions import collision_counts
from sag.metrics.frechet import frechet_distance
from sag.metrics.motion_fid import MotionFID, motion_fid_floor
from sag.metrics.non_collision import NonCollisionRatio

__all__ = [
    "MotionFID",
    "NonCollisionRatio",
    "collision_counts",
    "frechet_distance",
    "motion_fid_floor",
    "points_in_capsules",
]
