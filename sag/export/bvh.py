"""BVH: a hierarchy of joints and what each channel is in every frame."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag.export.bvh_reader import bvh_name
from sag.export.checking import check_motion, check_suffix
from sag.export.rig import UP, Rig, median_lengths, rest_direction, rig_of
from sag.export.units import UNITS, Unit
from sag.files import write_whole, writing_in
from sag.skeleton import Skeleton

EXACT = 5e-5
"""Metres by which no joint may be off in a file that calls itself exact: with what rounding adds, under 0.1 mm."""

TIP = 0.1
"""Length of what is drawn beyond a joint without children, metres."""

ORDER = "ZXY"
"""Axes in the order in which a joint's channels turn it, the last one first."""


@dataclass(frozen=True)
class BvhForm:
    """What was written of a motion.

    Attributes:
        rigid: bones keep their median lengths and only turn; otherwise every joint has channels for its place.
        largest: distance of a joint in the file from where it was, the largest, metres.
        mean: the same, its mean over joints and frames.
    """

    rigid: bool
    largest: float
    mean: float


def write_bvh(
    path: Path,
    joints: Float[np.ndarray, "t j 3"],
    skeleton: Skeleton,
    fps: float,
    unit: Unit = "cm",
    rigid: bool | None = None,
) -> BvhForm:
    """Writes a motion as BVH, whole or not at all.

    BVH has one length for each bone. Where bones keep theirs, a joint has three rotations, and where several bones
    begin at a joint each has a node `parent_to_child` at it, so that all of them turn freely. Where bones stretch, as
    generated ones do, every joint has channels for its place in its parent's axes besides, which stand instead of its
    offset, as Blender reads them; readers that know rotations only, such as pybvh, refuse such a file.

    Args:
        path: of the file, which ends in .bvh.
        joints: metres, Y up.
        skeleton: whose joints they are.
        fps: frames a second.
        unit: of the lengths in the file.
        rigid: whether bones only turn, at their median lengths; by default only if that moves no joint by `EXACT`.

    Returns:
        Which of the two it is, and how far joints are off.

    Raises:
        SagError: the motion is not finite or not of the skeleton, or the file cannot be written.
    """
    check_suffix(path, ".bvh")
    check_motion(joints, skeleton, fps)
    joints = joints.astype(np.float64)
    lengths = median_lengths(joints, skeleton)
    rig = rig_of(skeleton, lengths, split=True)
    turns = rig.rotations(joints)
    steps = rig.rigid_steps(joints)
    form = _form(rig, rig.posed(steps, turns), joints, rigid=True)
    if not (form.largest <= EXACT if rigid is None else rigid):
        rig = rig_of(skeleton, lengths, split=False)
        turns = rig.rotations(joints)
        steps = rig.steps(joints, turns)
        form = _form(rig, rig.posed(steps, turns), joints, rigid=False)
    text = _hierarchy(rig, skeleton, 1 / UNITS[unit], form.rigid) + _frames(steps / UNITS[unit], turns, fps, form.rigid)
    with writing_in(path, "name another place"):
        write_whole(path, lambda file: file.write(text.encode()))
    return form


def _form(rig: Rig, placed: np.ndarray, joints: np.ndarray, rigid: bool) -> BvhForm:
    _, nodes = np.unique(rig.joints, return_index=True)  # several may stand at one joint
    distance = np.linalg.norm(placed[:, nodes] - joints, axis=-1)
    return BvhForm(rigid, float(distance.max()), float(distance.mean()))


def _hierarchy(rig: Rig, skeleton: Skeleton, scale: float, rigid: bool) -> str:
    rotations = " ".join(f"{axis}rotation" for axis in ORDER)
    positions = "Xposition Yposition Zposition"
    lines = ["HIERARCHY"]

    def put(node: int, depth: int) -> None:
        tab, inner = "\t" * depth, "\t" * (depth + 1)
        moves = depth == 0 or not rigid
        lines.append(f"{tab}{'JOINT' if depth else 'ROOT'} {bvh_name(rig.names[node])}")
        lines.append(f"{tab}{{")
        lines.append(f"{inner}OFFSET {_numbers(scale * rig.offsets[node])}")
        lines.append(f"{inner}CHANNELS {f'6 {positions}' if moves else '3'} {rotations}")
        for child in rig.children(node):
            put(child, depth + 1)
        if not rig.children(node):
            tip = scale * TIP * _tip(skeleton, rig.names[node])
            lines.extend([f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET {_numbers(tip)}", f"{inner}}}"])
        lines.append(f"{tab}}}")

    put(0, 0)
    return "\n".join(lines) + "\n"


def _tip(skeleton: Skeleton, joint: str) -> np.ndarray:
    """Where a joint without children points in the rest pose: on along its bone, feet forward."""
    above = {end: start for start, end in skeleton.bones}
    if joint in [skeleton.joints[place] for place in skeleton.feet]:
        return rest_direction(skeleton, joint, "")
    return rest_direction(skeleton, above[joint], joint) if joint in above else UP


def _frames(steps: np.ndarray, turns: np.ndarray, fps: float, rigid: bool) -> str:
    """The motion, a line each frame."""
    count, nodes = steps.shape[:2]
    angles = _angles(turns)
    columns = np.concatenate([steps, angles], axis=-1)
    moving = columns[:, : 1 if rigid else nodes].reshape(count, -1)
    values = np.concatenate([moving, angles[:, 1 if rigid else nodes :].reshape(count, -1)], axis=1)
    lines = [f"MOTION\nFrames: {count}\nFrame Time: {1 / fps:.10f}", *map(_numbers, values)]
    return "\n".join(lines) + "\n"


def _angles(turns: np.ndarray) -> np.ndarray:
    """Degrees about the axes of `ORDER`, without jumps by whole turns from frame to frame."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Gimbal lock")  # the turn is the same, whichever angles make it
        angles = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_euler(ORDER, degrees=True)
    return np.unwrap(angles.reshape(*turns.shape[:2], 3), period=360, axis=0)


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.6f}" for value in values.tolist())
