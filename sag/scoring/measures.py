"""Measures: what is on the score sheet, and what each metric is fed of the motions that are judged."""

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
class Measure:
    """A metric on the score sheet.

    Attributes:
        name: of its figures.
        metric: the metric.
        feed: gives it what it measures.
    """

    name: str
    metric: Metric
    feed: Feed


def measures_of(
    split: str, data: MotionDataModule, encoders: ClipEncoders | None, evaluation: Evaluation, drawn: bool
) -> list[Measure]:
    """All that can be measured on a split: without encoders, depth, known geometry or other rooms, less.

    Args:
        split: "val" or "test"; only test windows have depth clouds, all those of the rooms a geometry.
        data: where the windows come from.
        encoders: of Motion FID, if there are any.
        evaluation: the protocol.
        drawn: whether motions are drawn, so that they can differ from each other and from the truth.
    """
    measures = motion_measures(data)
    if encoders is not None:
        measures = encoded_measures(data, encoders) + measures
    if drawn:
        measures += sample_measures(data, encoders, evaluation.samples)
    return measures + scene_measures(split, data, evaluation)


def encoded_measures(data: MotionDataModule, encoders: ClipEncoders) -> list[Measure]:
    """What compares features of clips."""
    root = data.skeleton.root_index

    def compare(metric: Any, judged: Judged, **more: Any) -> None:
        metric.update_features(judged.true_features, real=True, **more)
        metric.update_features(judged.features, real=False, **more)

    def compare_by_index(metric: Any, judged: Judged) -> None:
        compare(metric, judged, index=judged.batch.index)

    return [
        Measure("motion_fid", MotionFID(encoders, root), compare),
        Measure("motion_kid", MotionKID(encoders, root), compare_by_index),
    ]


def motion_measures(data: MotionDataModule) -> list[Measure]:
    """What needs motions alone."""

    def compare(metric: Any, judged: Judged) -> None:
        metric.update(judged.truth, real=True)
        metric.update(judged.joints, real=False)

    def single(metric: Any, judged: Judged) -> None:
        metric.update(judged.joints)

    fps, skeleton = data.fps, data.skeleton
    return [
        Measure("velocity_frechet", VelocityFrechet(fps, len(skeleton.joints)), compare),
        Measure("bone_drift", BoneDrift(skeleton.bone_index), single),
        Measure("acceleration", Acceleration(fps), single),
        Measure("jerk", Jerk(fps), single),
    ]


def sample_measures(data: MotionDataModule, encoders: ClipEncoders | None, samples: int) -> list[Measure]:
    """What holds the motions of a window against each other and against the true one."""
    root = data.skeleton.root_index
    measures = [Measure("best_of", BestOfK(root, data.fps), _compare_samples)]
    if samples < 2:
        return measures
    measures += [
        Measure("diversity/pairwise", AveragePairwiseDistance(), _samples),
        Measure("diversity/deviation", SampleDeviation(root), _samples),
    ]
    if encoders is not None:
        measures.append(Measure("diversity/multimodality", Multimodality(encoders, root), _samples))
    return measures


def scene_measures(split: str, data: MotionDataModule, evaluation: Evaluation) -> list[Measure]:
    """What needs the depth cloud, the floor or the known geometry of the scene; a floor is known or seen in a cloud."""
    rows = data.cache.rows(split)
    known = bool(len(rows)) and data.geometry(int(data.cache.scene[rows[0]])) is not None
    measures = cloud_measures(data, evaluation) if split == "test" else []
    if split == "test" or known:
        measures += floor_measures(data)
    if known:
        penetration = Penetration(data.skeleton.bone_index, data.skeleton.root_index, every=4)
        measures.append(Measure("penetration", penetration, _penetrate))
    return measures


def cloud_measures(data: MotionDataModule, evaluation: Evaluation) -> list[Measure]:
    """What needs the depth clouds of the test windows: their own, and another room's where there are several."""
    rows, bones = data.cache.rows("test"), data.skeleton.bone_index
    protocol: dict[str, Any] = {
        "frames": max(1, min(GENERATED, round(evaluation.collision_frames / max(1, len(rows))))),
        "unit": evaluation.collision_unit,
        "shape": evaluation.collision_shape,
        "seed": evaluation.seed,
    }
    measures = [
        Measure("non_collision", NonCollisionRatio(bones, **protocol), _collide),
        Measure("scene_frechet", SceneFrechet(data.skeleton.root_index), _compare_in_scene),
    ]
    if len(set(data.cache.scene[rows].tolist())) > 1:
        measures.append(Measure("collisions", SceneAwareness(bones, **protocol), _collide_elsewhere))
    return measures


def floor_measures(data: MotionDataModule) -> list[Measure]:
    """What the feet do on the floor."""
    feet, ankle = data.skeleton.feet, {"ankle_height": data.ankle_height}

    def on_floor(metric: Any, judged: Judged) -> None:
        metric.update(judged.world, judged.floor)

    return [
        Measure("foot_skate", FootSkate(feet, data.fps, **ankle), on_floor),
        Measure("foot_contact", FootContact(feet, data.fps, **ankle), on_floor),
        Measure("floor", FloorError(feet, **ankle), on_floor),
    ]


def _samples(metric: Any, judged: Judged) -> None:
    metric.update(judged.samples)


def _compare_samples(metric: Any, judged: Judged) -> None:
    metric.update(judged.samples, judged.truth)


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
