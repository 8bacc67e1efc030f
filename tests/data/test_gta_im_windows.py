from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from gta_im_files import COLUMNS, ROWS, SIZE, Sequence, form, module
from PIL import Image
from skeletons import chest_rooted

from sag.data.gta_im.filters import events, usable_starts
from sag.data.gta_im.recording import JOINTS, Recording
from sag.data.gta_im.views import stored_window
from sag.data.recordings import filters as why
from sag.data.recordings.splits import RoomSplit
from sag.errors import SagError
from sag.skeleton import GTA_IM_19, PROX_16
from sag.types import FRAMES

PAPER = RoomSplit((1, 2, 3, 6, 10, 11), (10, 11, 13), 0.5, 0.05)


@pytest.fixture
def recording(tmp_path) -> Recording:
    return Recording.read(Sequence().write(tmp_path / "a", pictured=[0]))


# --- its numbers: filters ---


def faults(tmp_path: Path, sequence: Sequence, pictured=range(6), **limits: float) -> tuple[list[int], Counter[str]]:
    recording = Recording.read(sequence.write(tmp_path / "a", pictured=pictured))
    return usable_starts(recording, 1, form(**limits))


def test_whole_windows_are_kept(tmp_path):
    assert faults(tmp_path, Sequence()) == (list(range(6)), Counter())


def test_starts_without_all_three_pictures_are_dropped(tmp_path):
    folder = Sequence().write(tmp_path / "a", pictured=[0, 1, 2, 5])
    for name in ("00000.jpg", "00001.png", "00002_id.png"):
        (folder / name).unlink()
    starts, dropped = usable_starts(Recording.read(folder), 1, form())
    assert starts == [5] and dropped == {why.NO_PICTURE: 5}


def test_windows_across_a_teleport_are_dropped(tmp_path):
    sequence = Sequence()
    sequence.roots[3:] += [0.31, 0, 0]
    # The jump from frame 2 to 3 lies inside the windows that start at 0, 1 and 2.
    assert faults(tmp_path, sequence) == ([3, 4, 5], Counter({why.ROOT_JUMPS: 3}))


def test_a_teleport_in_the_last_frame_counts(tmp_path):
    sequence = Sequence()
    sequence.roots[66:] += [0.31, 0, 0]
    assert faults(tmp_path, sequence) == ([0, 1], Counter({why.ROOT_JUMPS: 4}))


def test_the_longest_root_step_is_a_parameter(tmp_path):
    sequence = Sequence()
    sequence.roots[3:] += [0.31, 0, 0]
    assert faults(tmp_path, sequence, root_step=0.4)[0] == list(range(6))


def test_windows_with_a_joint_behind_the_start_camera_are_dropped(tmp_path):
    sequence = Sequence()
    sequence.offsets[67, JOINTS.index("left_wrist")] = [0, -9, 0]
    assert faults(tmp_path, sequence) == ([0, 1, 2], Counter({why.JOINT_BEHIND: 3}))


def test_windows_whose_root_leaves_the_start_picture_are_dropped(tmp_path):
    sequence = Sequence()
    sequence.roots[:] = sequence.roots[0] + 0.1 * np.arange(70)[:, None] * [1, 0, 0]
    assert faults(tmp_path, sequence) == ([], Counter({why.ROOT_OUTSIDE: 6}))


def test_starts_without_clip_planes_are_dropped(tmp_path):
    sequence = Sequence()
    sequence.clips = sequence.clips[:3]
    del sequence.clips[1]["cam_near_clip"]
    assert faults(tmp_path, sequence) == ([0, 2], Counter({why.NO_CLIPS: 4}))


@pytest.mark.parametrize(("order", "kept"), [("odd first", 2), ("odd last", 2), ("tie", 1)])
def test_recordings_whose_pictures_are_not_of_the_most_common_size_are_left_out_by_name(tmp_path, order, kept):
    names = {"odd first": "baz", "odd last": "xyz", "tie": "xz"}[order]
    odd = {"odd first": "b", "odd last": "z", "tie": "z"}[order]
    for name in names:
        folder = Sequence().write(tmp_path / "FPS-30" / name)
        if name == odd:
            with np.load(folder / "info_frames.npz") as file:
                arrays = dict(file)
            arrays["intrinsics"][:, :2] *= 2
            np.savez(folder / "info_frames.npz", **arrays)
    if order == "odd first":
        (tmp_path / "FPS-30" / "b").rename(tmp_path / "FPS-30" / "0")
        odd = "0"
    plan = module(tmp_path, tmp_path, stride=1).plan()
    assert plan.size == (ROWS, COLUMNS) and plan.dropped == {why.OTHER_SIZE: 6}
    assert {plan.folders[window.recording].name for window in plan.windows} == {*names} - {"b", odd}
    (note,) = (note for note in plan.notes if "LEFT OUT" in note)
    assert note == f"1 recordings LEFT OUT, their pictures are not of {(ROWS, COLUMNS)} pixels as most are: {odd}"


def test_recordings_without_windows_do_not_decide_on_the_size(tmp_path):
    for name in "ab":
        folder = Sequence(FRAMES - 1).write(tmp_path / "FPS-30" / name)
        with np.load(folder / "info_frames.npz") as file:
            arrays = dict(file)
        arrays["intrinsics"][:, :2] *= 2
        np.savez(folder / "info_frames.npz", **arrays)
    Sequence().write(tmp_path / "FPS-30" / "c")
    assert module(tmp_path, tmp_path).plan().size == (ROWS, COLUMNS)


def test_what_a_skeleton_does_not_use_is_not_looked_at(tmp_path):
    sequence = Sequence()
    sequence.offsets[66:, JOINTS.index("left_clavicle")] = [0, -9, 0]
    sequence.offsets[67:, JOINTS.index("spine2")] = [0, -9, 0]
    recording = Recording.read(sequence.write(tmp_path / "a"))
    assert usable_starts(recording, 1, form(PROX_16)) == (list(range(6)), Counter())
    assert usable_starts(recording, 1, form(GTA_IM_19)) == ([0, 1, 2], Counter({why.JOINT_BEHIND: 3}))


def test_windows_are_filtered_by_the_root_of_the_skeleton(tmp_path):
    sequence = Sequence()
    sequence.offsets[66:, JOINTS.index("spine0")] += [0.31, 0, 0]
    recording = Recording.read(sequence.write(tmp_path / "a"))
    assert usable_starts(recording, 1, form(PROX_16)) == (list(range(6)), Counter())
    assert events(recording, form(PROX_16))["root jumps"] == 0
    assert usable_starts(recording, 1, form(chest_rooted())) == ([0, 1], Counter({why.ROOT_JUMPS: 4}))
    assert events(recording, form(chest_rooted()))["root jumps"] == 1


def test_windows_are_centred_on_the_root_of_the_skeleton(tmp_path):
    recording = Recording.read(Sequence().write(tmp_path / "a"))
    for skeleton in (GTA_IM_19, PROX_16, chest_rooted()):
        window = stored_window(recording, 2, form(skeleton), False)
        centre = window["intrinsics"] @ window["joints"][0, skeleton.root_index]
        np.testing.assert_allclose(centre[:2] / centre[2], [SIZE[1] / 2, SIZE[0] / 2], atol=1e-3)


def test_short_recordings_are_dropped(tmp_path):
    assert faults(tmp_path, Sequence(FRAMES - 1)) == ([], Counter({why.TOO_SHORT: 1}))


def test_a_far_clip_that_is_not_told_is_800(tmp_path):
    sequence = Sequence()
    for frame in sequence.clips:
        del frame["cam_far_clip"]
    recording = Recording.read(sequence.write(tmp_path / "a", pictured=[]))
    np.testing.assert_array_equal(recording.clips[:, 1], 800)


def test_what_only_decoding_finds_is_dropped_and_counted(tmp_path):
    folder = Sequence().write(tmp_path / "FPS-30" / "a")
    torn = folder / "00001.jpg"
    torn.write_bytes(torn.read_bytes()[:900])
    Image.fromarray(np.zeros((ROWS, COLUMNS, 3), np.uint8)).save(folder / "00002_id.png")
    Image.fromarray(np.zeros((ROWS, COLUMNS + 1, 3), np.uint8)).save(folder / "00003.png")
    index = module(tmp_path, tmp_path).build().index
    # Thrice: in training, validation and test windows.
    assert index["dropped"] == {why.UNREADABLE: 6, why.HIDDEN: 3}
    assert any("00001.jpg is damaged" in note for note in index["notes"])


# --- its numbers: splits ---


def test_rooms_in_both_lists_are_divided_by_recording():
    rooms = [1] * 10 + [2] * 10 + [3] * 10 + [6] * 10 + [10] * 20 + [11] * 20 + [13] * 10 + [99]
    split = PAPER.divided(rooms)
    assert not set(split.train) & set(split.test) and not set(split.val) & {*split.train, *split.test}
    assert len(split.test) == 30 and len(split.train) + len(split.val) == 60
    assert {rooms[i] for i in split.test} == {10, 11, 13}
    assert {rooms[i] for i in split.train} == {1, 2, 3, 6, 10, 11}
    assert len(split.val) == 3 and not split.notes


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"val_share": 5.0}, "val_share must be at least 0 and below 1, found 5.0"),
        ({"val_share": 1.0}, "val_share must be"),
        ({"val_share": -0.1}, "val_share must be"),
        ({"val_share": float("nan")}, "val_share must be"),
        ({"shared_test_share": 0.0}, "shared_test_share must lie between 0 and 1, found 0.0"),
        ({"shared_test_share": 1.0}, "shared_test_share must lie"),
        ({"train_rooms": (1, 2, 1)}, "train_rooms names the room 1 2 times"),
        ({"test_rooms": (10, 10, 13)}, "test_rooms names the room 10 2 times"),
    ],
)
def test_impossible_splits_are_refused_by_the_name_of_the_option(tmp_path, wrong, said):
    with pytest.raises(SagError, match=f"^data.init_args.{said}"):
        module(tmp_path, tmp_path, **wrong)


@pytest.mark.parametrize("count", range(2, 9))
def test_unknown_rooms_are_split_by_recording_aloud(count):
    split = PAPER.divided([77] * count)
    assert split.train and split.val and split.test
    assert not set(split.test) & {*split.train, *split.val}
    assert split.notes[0].startswith("SPLIT BY RECORDING") and "[77]" in split.notes[0]
    assert (len(split.notes) == 2) == bool(set(split.val) & set(split.train))


def test_one_recording_is_everything_aloud():
    split = PAPER.divided([1])
    assert split.train == split.val == split.test == (0,)
    assert [note.split(":")[0] for note in split.notes] == [
        "TRAINING AND TEST WINDOWS ARE THE SAME, figures mean nothing",
        "VALIDATION WINDOWS ARE TRAINING WINDOWS",
    ]
