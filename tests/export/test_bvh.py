"""BVH: what is written is what others read, to a tenth of a millimetre, and what is lost is told."""

from pathlib import Path

import numpy as np
import pybvh
import pytest
from export_motions import rigid_motion, stretching_motion
from scipy.spatial.transform import Rotation

from sag.errors import SagError
from sag.export import read_bvh, write_bvh
from sag.skeleton import GTA_IM_19, PROX_16, Skeleton

TENTH = 1e-4
"""Metres."""


def by_pybvh(path: Path, skeleton: Skeleton, unit: float = 0.01) -> tuple[np.ndarray, float]:
    """Joints in metres and frames a second, as pybvh reads them."""
    read = pybvh.read_bvh_file(path, world_up="+y")
    order = [list(read.joint_names).index(name) for name in skeleton.joints]
    return read.joint_positions()[:, order] * unit, read.fps


@pytest.mark.parametrize("skeleton", [GTA_IM_19, PROX_16], ids=lambda s: s.name)
def test_pybvh_reads_bones_that_keep_their_lengths(skeleton, tmp_path):
    joints, path = rigid_motion(skeleton), tmp_path / "motion.bvh"
    form = write_bvh(path, joints, skeleton, 30.0)
    found, fps = by_pybvh(path, skeleton)
    assert form.rigid and form.largest < TENTH and fps == pytest.approx(30)
    assert np.abs(found - joints).max() < TENTH
    assert np.abs(read_bvh(path).of(skeleton) - joints).max() < TENTH


def test_bones_that_stretch_come_back_exactly_by_channels_for_places(tmp_path):
    joints, path = stretching_motion(), tmp_path / "motion.bvh"
    form = write_bvh(path, joints, GTA_IM_19, 25.0, unit="m")
    read = read_bvh(path, unit="m")
    assert not form.rigid and form.largest < 1e-9
    assert np.abs(read.of(GTA_IM_19) - joints).max() < TENTH and read.fps == pytest.approx(25)
    assert path.read_text().count("CHANNELS 6") == len(read.names) == 19


def test_rigid_turns_bones_only_and_tells_what_that_moves(tmp_path):
    joints, path = stretching_motion(), tmp_path / "motion.bvh"
    form = write_bvh(path, joints, GTA_IM_19, 30.0, rigid=True)
    found, _ = by_pybvh(path, GTA_IM_19)
    off = np.linalg.norm(found - joints, axis=-1)
    assert form.rigid and off.max() == pytest.approx(form.largest, abs=TENTH) and off.max() > 0.02
    assert off.mean() == pytest.approx(form.mean, abs=TENTH)
    for parent, child in GTA_IM_19.bone_index:
        assert np.ptp(np.linalg.norm(found[:, child] - found[:, parent], axis=-1)) < TENTH
        ways = (x[:, child] - x[:, parent] for x in (found, joints))
        first, second = (way / np.linalg.norm(way, axis=-1, keepdims=True) for way in ways)
        assert np.abs(first - second).max() < 1e-4  # only lengths are lost, not directions


def test_one_median_length_is_the_offset_in_centimetres(tmp_path):
    joints, path = stretching_motion(frames=9), tmp_path / "motion.bvh"
    write_bvh(path, joints, GTA_IM_19, 30.0)
    knee, ankle = GTA_IM_19.index("left_knee", "left_ankle")
    median = 100 * np.median(np.linalg.norm(joints[:, ankle] - joints[:, knee], axis=-1))
    after = path.read_text().partition("JOINT left_ankle")[2]
    assert np.allclose([float(word) for word in after.split()[2:5]], [0, -median, 0], atol=1e-5)


def test_the_rest_pose_is_a_t_that_faces_z(tmp_path):
    path = tmp_path / "motion.bvh"
    write_bvh(path, rigid_motion(), GTA_IM_19, 30.0)
    read = pybvh.read_bvh_file(path, world_up="+y")
    place = dict(zip((node.name for node in read.nodes), read.rest_pose_positions()))
    assert place["left_wrist"][0] > place["left_shoulder"][0] > 0 > place["right_hip"][0]
    assert place["head"][1] > place["neck"][1] > 0 > place["left_knee"][1] > place["left_ankle"][1]


def test_a_pose_in_which_nothing_moves_and_bones_point_backwards(tmp_path):
    joints, path = rigid_motion(frames=1), tmp_path / "motion.bvh"
    joints = joints - joints[:, [GTA_IM_19.root_index]]
    for upside_down in (joints * [1, -1, -1], joints * [-1, 1, -1], 0 * joints):
        write_bvh(path, upside_down, GTA_IM_19, 30.0, rigid=False)
        assert np.abs(read_bvh(path).of(GTA_IM_19) - upside_down).max() < TENTH


def test_angles_do_not_jump_by_whole_turns(tmp_path):
    path = tmp_path / "motion.bvh"
    turns = Rotation.from_euler("y", np.linspace(0, 350, 40)[:, None], degrees=True).as_matrix()
    write_bvh(path, rigid_motion(frames=1, turn=0.0) @ turns.swapaxes(1, 2), GTA_IM_19, 30.0)
    frames = np.array([line.split() for line in path.read_text().partition("Frame Time")[2].splitlines()[1:]], float)
    assert np.allclose(np.diff(frames[:, 5]), 350 / 39, atol=0.02)


@pytest.mark.parametrize(
    ("change", "fps", "sentence"),
    [
        (
            lambda j: np.where(np.arange(19)[:, None] == 3, np.nan, j),
            30.0,
            "right_elbow in frame 0 is at no finite",
        ),
        (lambda j: j[:, :18], 30.0, "joints are 18, and skeleton gta_im_19 has 19"),
        (lambda j: j[:0], 30.0, "the motion has no frames"),
        (lambda j: 1000 * j, 30.0, "joints are to be in metres"),
        (lambda j: j, 0.0, "fps is 0.0"),
    ],
    ids=["NaN", "joints", "empty", "millimetres", "fps"],
)
def test_refuses_motions(change, fps, sentence, tmp_path):
    with pytest.raises(SagError, match=sentence):
        write_bvh(tmp_path / "motion.bvh", change(rigid_motion()), GTA_IM_19, fps)
    assert not list(tmp_path.iterdir())


def test_refuses_places(tmp_path):
    (tmp_path / "file").write_text("")
    for name, sentence in (
        ("motion.txt", "must be a file that ends in .bvh"),
        ("file/motion.bvh", "cannot be written"),
    ):
        with pytest.raises(SagError, match=sentence):
            write_bvh(tmp_path / name, rigid_motion(), GTA_IM_19, 30.0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda text: text[: len(text) // 2], "no BVH file of one root"),
        (lambda text: text.replace("HIERARCHY", "{}"), "stands where HIERARCHY must"),
        (lambda text: text.replace("Xposition", "Wposition"), "channels are Wposition"),
        (lambda text: text.replace("Frame Time: 0.03", "Frame Time: -0.03"), "its frame time is -0.03"),
        (lambda text: text.replace("JOINT", "BONE", 1), "'BONE' stands in its hierarchy"),
        (lambda text: "HIERARCHY ROOT", "ends too early"),
    ],
    ids=["half", "heading", "channel", "time", "word", "beginning"],
)
def test_refuses_to_read(change, sentence, tmp_path):
    path = tmp_path / "motion.bvh"
    write_bvh(path, rigid_motion(), GTA_IM_19, 30.0)
    path.write_text(change(path.read_text()))
    with pytest.raises(SagError, match=sentence):
        read_bvh(path)
    with pytest.raises(SagError, match="cannot be read"):
        read_bvh(tmp_path / "nothing.bvh")


def test_a_file_of_other_joints_is_not_taken_for_a_skeleton(tmp_path):
    write_bvh(tmp_path / "motion.bvh", rigid_motion(PROX_16), PROX_16, 30.0)
    with pytest.raises(SagError, match="has no joint spine0, which gta_im_19 has"):
        read_bvh(tmp_path / "motion.bvh").of(GTA_IM_19)


def test_names_of_several_words_become_one(tmp_path):
    swapped = {"head": "top of {head}"}
    renamed = Skeleton(
        "named", tuple(swapped.get(n, n) for n in PROX_16.joints),
        tuple((a, swapped.get(b, b)) for a, b in PROX_16.bones), "root",
        {k: tuple(swapped.get(n, n) for n in v) for k, v in PROX_16.parts.items()}, PROX_16.limbs,
    )  # fmt: skip
    joints = rigid_motion(renamed)
    write_bvh(tmp_path / "motion.bvh", joints, renamed, 30.0)
    assert np.abs(read_bvh(tmp_path / "motion.bvh").of(renamed) - joints).max() < TENTH
