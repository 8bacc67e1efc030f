"""Metrics of human motion in scenes: functions and torchmetrics classes; docs/metrics.md has them all in one table."""

from sag.geometry.capsule import points_in_capsules
from sag.metrics.collisions.counts import collision_counts, collision_counts_in_cloud
from sag.metrics.collisions.details import collision_details
from sag.metrics.collisions.non_collision import NonCollisionRatio
from sag.metrics.collisions.scene_awareness import SceneAwareness
from sag.metrics.fid.clips import clip_features
from sag.metrics.fid.floor import motion_fid_floor
from sag.metrics.fid.infinity import motion_fid_infinity
from sag.metrics.fid.interval import motion_fid_interval
from sag.metrics.fid.kid import MotionKID, motion_kid
from sag.metrics.fid.motion_fid import MotionFID, motion_fid_of_features
from sag.metrics.fid.multimodality import Multimodality
from sag.metrics.frechet import Gaussian, frechet_distance
from sag.metrics.motion.best_of_k import BestOfK, motion_error
from sag.metrics.motion.bone_drift import BoneDrift, bone_drift
from sag.metrics.motion.pairwise_distance import AveragePairwiseDistance, pairwise_distance
from sag.metrics.motion.sample_deviation import SampleDeviation, sample_deviation
from sag.metrics.motion.seams import SeamJerk, seam_jerks, velocity_jumps
from sag.metrics.motion.smoothness import Acceleration, Jerk
from sag.metrics.motion.velocity_frechet import VelocityFrechet, velocity_frechet
from sag.metrics.scene.depth_error import DepthError, depth_errors
from sag.metrics.scene.depth_probe import DepthProbe
from sag.metrics.scene.feet import FootContact, FootSkate, footing
from sag.metrics.scene.floor_error import FloorError, known_floor
from sag.metrics.scene.floor_from_depth import floor_under_feet
from sag.metrics.scene.penetration import Penetration, deepest_penetration
from sag.metrics.scene.scene_frechet import SceneFrechet

__all__ = [
    "Acceleration",
    "AveragePairwiseDistance",
    "BestOfK",
    "BoneDrift",
    "DepthError",
    "DepthProbe",
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
    "SeamJerk",
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
    "seam_jerks",
    "velocity_frechet",
    "velocity_jumps",
]
