"""Lines of a score sheet: one metric each, and what it is fed of the motions that are judged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from torchmetrics import Metric

from sag.data.base import MotionDataModule
from sag.metrics import (
    Acceleration,
    AveragePairwiseDistance,
    BestOfK,
    BoneDrift,
    FloorError,
    FootContact,
    FootSkate,
    Jerk,
    MotionFID,
    MotionKID,
    Multimodality,
    NonCollisionRatio,
    Penetration,
    SampleDeviation,
    SceneAwareness,
    SceneFrechet,
    VelocityFrechet,
)
from sag.metrics.fid.clips import ClipEncoders
from sag.scoring.evaluation import Evaluation
from sag.scoring.judged import Judged
from sag.types import GENERATED

Feed = Callable[[Any, Judged], None]


@dataclass(frozen=True)
class Line:
    """A metric on the sheet.

    Attributes:
        name: of its figures.
        metric: the metric.
        feed: gives it what it measures.
    """

    name: str
    metric: Metric
    feed: Feed


def lines_of(split: str, data: MotionDataModule, encoders: ClipEncoders | None, evaluation: Evaluation) -> list[Line]:
    """Every line that can be measured on a split: without encoders, depth, known geometry or other rooms, fewer."""
    lines = motion_lines(data)
    if encoders is not None:
        lines = encoded_lines(data, encoders) + lines
    if evaluation.samples > 1:
        lines += sample_lines(data, encoders)
    if split == "test":
        lines += scene_lines(data, evaluation)
    return lines


def encoded_lines(data: MotionDataModule, encoders: ClipEncoders) -> list[Line]:
    """What compares features of clips."""
    root = data.skeleton.root_index

    def compare(metric: Any, judged: Judged, **more: Any) -> None:
        metric.update_features(judged.true_features, real=True, **more)
        metric.update_features(judged.features, real=False, **more)

    def compare_by_index(metric: Any, judged: Judged) -> None:
        compare(metric, judged, index=judged.batch.index)

    return [
        Line("motion_fid", MotionFID(encoders, root), compare),
        Line("motion_kid", MotionKID(encoders, root), compare_by_index),
    ]


def motion_lines(data: MotionDataModule) -> list[Line]:
    """What needs motions alone."""

    def compare(metric: Any, judged: Judged) -> None:
        metric.update(judged.truth, real=True)
        metric.update(judged.joints, real=False)

    def single(metric: Any, judged: Judged) -> None:
        metric.update(judged.joints)

    fps, skeleton = data.fps, data.skeleton
    return [
        Line("velocity_frechet", VelocityFrechet(fps, len(skeleton.joints)), compare),
        Line("bone_drift", BoneDrift(skeleton.bone_index), single),
        Line("acceleration", Acceleration(fps), single),
        Line("jerk", Jerk(fps), single),
        Line("best_of", BestOfK(skeleton.root_index, fps), lambda m, judged: m.update(judged.samples, judged.truth)),
    ]


def sample_lines(data: MotionDataModule, encoders: ClipEncoders | None) -> list[Line]:
    """What needs several motions of each window."""
    root = data.skeleton.root_index
    lines = [
        Line("diversity/pairwise", AveragePairwiseDistance(), _samples),
        Line("diversity/deviation", SampleDeviation(root), _samples),
    ]
    if encoders is not None:
        lines.append(Line("diversity/multimodality", Multimodality(encoders, root), _samples))
    return lines


def scene_lines(data: MotionDataModule, evaluation: Evaluation) -> list[Line]:
    """What needs the depth cloud, the floor or the known geometry of the scene."""
    rows = data.cache.rows("test")
    feet, bones = data.skeleton.index("right_ankle", "left_ankle"), data.skeleton.bone_index
    protocol: dict[str, Any] = {
        "frames": max(1, min(GENERATED, round(evaluation.collision_frames / max(1, len(rows))))),
        "unit": evaluation.collision_unit,
        "shape": evaluation.collision_shape,
    }

    def on_floor(metric: Any, judged: Judged) -> None:
        metric.update(judged.world, judged.floor)

    lines = [
        Line("non_collision", NonCollisionRatio(bones, **protocol), _collide),
        Line("scene_frechet", SceneFrechet(data.skeleton.root_index), _compare_in_scene),
        Line("foot_skate", FootSkate(feet, data.fps), on_floor),
        Line("foot_contact", FootContact(feet, data.fps), on_floor),
        Line("floor", FloorError(feet), on_floor),
    ]
    if len(set(data.cache.scene[rows].tolist())) > 1:
        lines.append(Line("collisions", SceneAwareness(bones, **protocol), _collide_elsewhere))
    if len(rows) and data.geometry(int(data.cache.scene[rows[0]])) is not None:
        lines.append(Line("penetration", Penetration(bones, data.skeleton.root_index, every=4), _penetrate))
    return lines


def _samples(metric: Any, judged: Judged) -> None:
    metric.update(judged.samples)


def _collide(metric: Any, judged: Judged) -> None:
    metric.update(judged.joints, judged.cloud, judged.batch.index)


def _collide_elsewhere(metric: Any, judged: Judged) -> None:
    other = judged.elsewhere
    assert other is not None and other.cloud is not None
    moved = judged.moved_to(other)
    metric.update(judged.joints, judged.cloud, moved, other.cloud, judged.batch.index)


def _compare_in_scene(metric: Any, judged: Judged) -> None:
    metric.update(judged.truth, judged.cloud, real=True)
    metric.update(judged.joints, judged.cloud, real=False)


def _penetrate(metric: Any, judged: Judged) -> None:
    metric.update(judged.world, judged.geometry)
