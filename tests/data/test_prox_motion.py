import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from prox_files import CAM2WORLD, SIZE, Take, form, skeleton, write_root
from skeletons import chest_rooted

from sag.data.prox.filters import PAUSE, events, usable_starts
from sag.data.prox.kinect import JOINTS, SDK_JOINTS, read_skeleton
from sag.data.prox.names import FrameName, RecordingName
from sag.data.prox.recording import Recording
from sag.data.prox.root import Root
from sag.data.prox.views import stored_window
from sag.data.recordings import filters as why
from sag.errors import SagError
from sag.skeleton import PROX_16

NAME = "MPH16_00157_01"


@pytest.fixture
def root(tmp_path) -> Path:
    return write_root(tmp_path / "root", ("MPH16",))


def read(root: Path, depth: str = "scan") -> Recording:
    return Root(root, None, depth).read(root / "recordings" / NAME)


# --- its numbers: skeletons ---


def test_kinect_joints_are_named_by_their_own_left_and_right():
    assert len(SDK_JOINTS) == 25 and set(JOINTS) < set(SDK_JOINTS)
    assert dict(zip(PROX_16.joints, JOINTS))["left_shoulder"] == "ShoulderLeft"
    assert dict(zip(PROX_16.joints, JOINTS))["root"] == "SpineBase"


def test_kinect_skeletons_come_to_the_colour_camera(root):
    take = Take()
    take.write(root, NAME)
    recording = read(root)
    np.testing.assert_allclose(recording.joints, take.joints, atol=1e-9)
    left, right = (recording.joints[0, PROX_16.joints.index(f"{side}_wrist"), 0] for side in ("left", "right"))
    assert left > right, "whoever faces the camera has their left on its right"


def test_joints_may_be_a_list_and_positions_too(tmp_path):
    told = skeleton(Take().joints[0])
    (tmp_path / "a.json").write_text(json.dumps(told))
    told["Bodies"] = told["Bodies"][1:]
    joints = told["Bodies"][0]["Joints"].values()
    told["Bodies"][0]["Joints"] = [{"Position": list(joint["Position"].values())} for joint in joints]
    (tmp_path / "b.json").write_text(json.dumps(told))
    np.testing.assert_array_equal(read_skeleton(tmp_path / "a.json"), read_skeleton(tmp_path / "b.json"))


@pytest.mark.parametrize("bodies", [[], [{"IsTracked": False}], [{"IsTracked": False, "Joints": {"Head": {}}}]])
def test_nobody_tracked_is_no_body(tmp_path, bodies):
    (tmp_path / "a.json").write_text(json.dumps({"Bodies": bodies}))
    assert np.isnan(read_skeleton(tmp_path / "a.json")).all()


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"Bodies": 3},
        {"Bodies": [3]},
        {"Bodies": [{"Joints": [1, 2]}]},
        {"Bodies": [{"Joints": {"Head": {}}}]},
        {"Bodies": [{"Joints": {name: {"Position": {"X": 1, "Y": 2}} for name in SDK_JOINTS}}]},
        {"Bodies": [{"Joints": {name: {"Position": [1, 2, float("inf")]} for name in SDK_JOINTS}}]},
    ],
)
def test_skeletons_of_another_layout_are_refused(tmp_path, content):
    (tmp_path / "a.json").write_text(json.dumps(content))
    with pytest.raises(SagError, match=r"a\.json"):
        read_skeleton(tmp_path / "a.json")


# --- its numbers: names, times and filters ---


def test_names_are_split_at_the_underscores():
    assert RecordingName.of("MPH1Library_00034_01") == RecordingName("MPH1Library", "00034", "01")
    assert RecordingName.of("MPH11_03403_01").is_of((3403,)) and not RecordingName.of("a_x_b").is_of((3403,))
    assert FrameName.of("s001_frame_00012__01.02.03.045", "") == FrameName(
        "s001_frame_00012__01.02.03.045", 12, 3723.045
    )


@pytest.mark.parametrize("name", ["MPH16", "MPH16_1", "MPH16__1", "MPH_16_1_2"])
def test_other_names_are_refused(name):
    with pytest.raises(SagError, match=name):
        RecordingName.of(name)


def test_world_and_camera_fit_the_scan(root):
    Take().write(root, NAME)
    np.testing.assert_allclose(read(root).world2cam @ CAM2WORLD, np.eye(4), atol=1e-12)


@pytest.mark.parametrize("seconds", [3.5, 1.0])
def test_frames_that_come_twice_are_refused(root, seconds):
    take = Take()
    folder = take.write(root, NAME)
    twice = folder / "Color" / f"s001_frame_00003__00.00.0{seconds:.3f}.jpg"
    (folder / "Color" / f"{take.names[0]}.jpg").rename(twice)
    with pytest.raises(SagError, match=r"Color: frame s001_frame_00003__\S+ does not come after s001_frame_00003__"):
        read(root)


def test_pictures_of_other_names_are_refused(root):
    folder = Take().write(root, NAME)
    (folder / "Color" / "00001.jpg").touch()
    with pytest.raises(SagError, match="Color holds a picture called '00001'"):
        read(root)


def starts(root: Path, take: Take, **options: object) -> tuple[list[int], Counter[str]]:
    take.write(root, NAME)
    return usable_starts(read(root, **options), 1, form())


def test_whole_windows_are_kept(root):
    assert starts(root, Take()) == (list(range(6)), Counter())


def test_a_trembling_clock_is_no_pause(root):
    take = Take()
    take.seconds[1::2] -= 0.012
    assert starts(root, take)[0] == list(range(6))


def test_windows_across_a_pause_are_dropped(root):
    take = Take()
    take.seconds[3:] += 0.1
    assert starts(root, take) == ([3, 4, 5], Counter({PAUSE: 3}))


def test_windows_across_a_teleport_are_dropped(root):
    take = Take()
    take.roots[66:] += [0, 0, 0.31]
    assert starts(root, take) == ([0, 1], Counter({why.ROOT_JUMPS: 4}))


def test_windows_with_a_joint_behind_the_camera_are_dropped(root):
    take = Take()
    take.roots[67:, 2] = 0.05
    assert starts(root, take) == ([0, 1, 2], Counter({why.JOINT_BEHIND: 3}))


def test_windows_whose_root_leaves_the_picture_are_dropped(root):
    take = Take()
    take.roots[69, 0] = 2.8
    assert starts(root, take) == ([0, 1, 2, 3, 4], Counter({why.ROOT_OUTSIDE: 1}))


def test_starts_without_measured_depth_are_dropped_where_it_is_used(root):
    take = Take()
    folder = take.write(root, NAME)
    (folder / "Depth" / f"{take.names[2]}.png").unlink()
    assert usable_starts(read(root), 1, form())[0] == list(range(6))
    found = usable_starts(read(root, depth="sensor"), 1, form())
    assert found == ([0, 1, 3, 4, 5], Counter({why.NO_PICTURE: 1}))


def test_short_recordings_are_dropped(root):
    assert starts(root, Take(64)) == ([], Counter({why.TOO_SHORT: 1}))


def test_windows_are_centred_on_and_filtered_by_the_root_of_the_skeleton(root):
    Take().write(root, NAME)
    recording, chest = read(root), PROX_16.joints.index("chest")
    for rooted in (PROX_16, chest_rooted()):
        window = stored_window(recording, 2, form(rooted), False)
        centre = window["intrinsics"] @ window["joints"][0, rooted.root_index]
        np.testing.assert_allclose(centre[:2] / centre[2], [SIZE[1] / 2, SIZE[0] / 2], atol=1e-3)
    recording.joints[66:, chest, 0] += 0.31
    assert usable_starts(recording, 1, form()) == (list(range(6)), Counter())
    assert usable_starts(recording, 1, form(chest_rooted())) == ([0, 1], Counter({why.ROOT_JUMPS: 4}))
    jumps = [events(recording, form(rooted))[why.ROOT_JUMPS] for rooted in (PROX_16, chest_rooted())]
    assert jumps == [0, 1]
    recording.joints[66:, chest, 0] += 99
    assert usable_starts(recording, 1, form(chest_rooted()))[1] == {why.ROOT_OUTSIDE: 4}
