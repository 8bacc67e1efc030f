"""Metrics of human motion in scenes: functions and torchmetrics classes; docs/metrics.md has them all in one table."""

from sag.geometry.capsule import points_in_capsules
from sag.metrics.best_of_k import BestOfK, motion_error
from sag.metrics.bone_drift import BoneDrift, bone_drift
from sag.metrics.clips import clip_features
from sag.metrics.collision_details import collision_details
from sag.metrics.collisions import collision_counts, collision_counts_in_cloud
from sag.metrics.depth_error import DepthError, depth_errors
from sag.metrics.feet import FootContact, FootSkate, footing
from sag.metrics.floor_error import FloorError, known_floor
from sag.metrics.floor_from_depth import floor_under_feet
from sag.metrics.frechet import Gaussian, frechet_distance
from sag.metrics.infinity import motion_fid_infinity
from sag.metrics.interval import motion_fid_interval
from sag.metrics.kid import MotionKID, motion_kid
from sag.metrics.motion_fid import MotionFID, motion_fid_of_features
from sag.metrics.motion_floor import motion_fid_floor
from sag.metrics.multimodality import Multimodality
from sag.metrics.non_collision import NonCollisionRatio
from sag.metrics.pairwise_distance import AveragePairwiseDistance, pairwise_distance
from sag.metrics.penetration import Penetration, deepest_penetration
from sag.metrics.sample_deviation import SampleDeviation, sample_deviation
from sag.metrics.scene_awareness import SceneAwareness
from sag.metrics.scene_frechet import SceneFrechet
from sag.metrics.smoothness import Acceleration, Jerk
from sag.metrics.velocity_frechet import VelocityFrechet, velocity_frechet

__all__ = [
    "Acceleration",
    "AveragePairwiseDistance",
    "BestOfK",
    "BoneDrift",
    "DepthError",
    "FloorError",
    "FootContact",
    "FootSkate",
    "Gaussian",
    "Jerk",
    "MotionFID",
    "MotionKID",
    "Multimodality",
    "NonCollisionRatio",
    "Penetration",
    "SampleDeviation",
    "SceneAwareness",
    "SceneFrechet",
    "VelocityFrechet",
    "bone_drift",
    "clip_features",
    "collision_counts",
    "collision_counts_in_cloud",
    "collision_details",
    "deepest_penetration",
    "depth_errors",
    "floor_under_feet",
    "footing",
    "frechet_distance",
    "known_floor",
    "motion_error",
    "motion_fid_floor",
    "motion_fid_infinity",
    "motion_fid_interval",
    "motion_fid_of_features",
    "motion_kid",
    "pairwise_distance",
    "points_in_capsules",
    "sample_deviation",
    "velocity_frechet",
]
