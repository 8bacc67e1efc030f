"""Figures of a single motion, for the table beside the scene."""

from __future__ import annotations

from typing import Literal, NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.metrics import BoneDrift, FootSkate, NonCollisionRatio, Penetration, collision_counts
from sag.metrics.collisions.clear_frames import RADII
from sag.scoring.judged import Judged
from sag.types import FRAMES, GENERATED

TOUCH = max(RADII)
"""Distance from a bone within which a point of the scene lights up, metres: the widest of the paper's radii."""


class Column(NamedTuple):
    """A column of the table.

    Attributes:
        key: of its figures.
        label: its heading.
        unit: of its figures.
        digits: behind the point.
        better: which figure is marked as the best.
        about: what it measures.
    """

    key: str
    label: str
    unit: str
    digits: int
    better: Literal["high", "low", "none"]
    about: str


COLUMNS = (
    Column(
        "non_collision", "clear", "", 2, "high",
        "Non-collision ratio: share of the generated frames in which few points of the scene lie in a bone",
    ),
    Column("penetration", "inside", "mm", 0, "low", "Mean depth of the bones inside furniture and walls"),
    Column("foot_skate", "skate", "m/s", 2, "low", "Mean speed of feet that touch the floor"),
    Column("bone_drift", "drift", "%", 0, "low", "How far bones are from their length in the given frame"),
    Column("path", "path", "m", 1, "none", "Length of the root's way"),
    Column("off", "off", "m", 2, "low", "Mean distance of all joints from the recorded motion"),
)  # fmt: skip
"""What is known of a motion; a column that nobody fills is not shown."""


def figures_of(judged: Judged, off: bool) -> dict[str, float]:
    """Figures of one motion of one window, by the key of their column; NaN where they have no meaning.

    Most are defined for 65 frames; of another number only the way of the root is told.

    Args:
        judged: a single window with a single motion.
        off: whether it is held against the recorded motion, which then must be as long.
    """
    root = judged.joints[0, :, judged.skeleton.root_index].double()
    found = {"path": float(root.diff(dim=0).norm(dim=-1).sum())}
    if off:
        found["off"] = float((judged.joints - judged.truth)[:, 1:].norm(dim=-1).mean())
    return found if judged.joints.shape[1] != FRAMES else found | _of_body(judged) | _in_scene(judged)


def _of_body(judged: Judged) -> dict[str, float]:
    """Figures that need no scene, and skating feet where the floor under them is known or seen."""
    skeleton, found = judged.skeleton, {}
    drift = BoneDrift(skeleton.bone_index)
    drift.update(judged.joints)
    found["bone_drift"] = 100 * float(drift.compute())
    if judged.batch.cloud is not None or judged.geometry:
        skate = FootSkate(skeleton.feet, judged.data.fps, ankle_height=judged.data.ankle_height)
        skate.update(judged.world, judged.floor)
        found["foot_skate"] = float(skate.compute())
    return found


def _in_scene(judged: Judged) -> dict[str, float]:
    """Figures that need the depth cloud, or a room that is known."""
    found, bones = {}, judged.skeleton.bone_index
    if _has_points(judged):
        clear = NonCollisionRatio(bones, frames=GENERATED)
        clear.update(judged.joints, judged.cloud)
        found["non_collision"] = float(clear.compute()["average"])
    if judged.geometry:
        inside = Penetration(bones, judged.skeleton.root_index)
        inside.update(judged.world, judged.geometry)
        found["penetration"] = 1000 * float(inside.compute()["depth"])
    return found


def touched_points(judged: Judged) -> Int[Tensor, " t"] | None:
    """Points of the scene within `TOUCH` of a bone at each frame of one motion; None where there is no depth."""
    if not _has_points(judged):
        return None
    joints: Float[Tensor, "t j 3"] = judged.joints[0]
    bones = torch.as_tensor(judged.skeleton.bone_index)
    return collision_counts(joints, bones, judged.cloud.depth[0], judged.cloud.intrinsics[0], (TOUCH,))[:, 0]


def _has_points(judged: Judged) -> bool:
    return judged.batch.cloud is not None and bool((judged.batch.cloud.depth > 0).any())
