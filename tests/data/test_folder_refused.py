"""What is wrong in a folder of one's own is refused in one line that names the file."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from folder_files import COLUMNS, INTRINSICS, ROWS, WORLD2CAM, Take, module, write_root, write_skeleton
from hostile_files import flipped, linked, missing, replaced, truncated
from PIL import Image

from sag.errors import SagError
from sag.skeleton.tree import FEET

NPZ, COLOUR, DEPTH, PERSON = "motion.npz", "00000.jpg", "00000_depth.png", "00000_person.png"

Damage = Callable[[Path], object]


@pytest.fixture(scope="session")
def whole(tmp_path_factory) -> Path:
    """A data set of one window."""
    root = write_skeleton(tmp_path_factory.mktemp("whole") / "data" / "root")
    Take(65).write(root / "take0", pictured=[0])
    return root


def refusal(whole: Path, tmp_path: Path, damage: Damage) -> str:
    """What is said of the data set after damage to its recording."""
    root = shutil.copytree(whole, tmp_path / "data" / "root")
    damage(root / "take0")
    with pytest.raises(SagError) as error:
        module(root, tmp_path / "cache").build()
    assert "\n" not in str(error.value)
    return str(error.value)


def test_the_whole_one_is_read(whole, tmp_path):
    assert len(module(whole, tmp_path / "cache").build()) == 3


def told(**changes: Any) -> Damage:
    """Writes other arrays; nothing takes one away."""

    def damage(folder: Path) -> None:
        arrays = {**Take(65).arrays, **changes}
        np.savez(folder / NPZ, **{name: array for name, array in arrays.items() if array is not None})

    return damage


def joints(change: Callable[[np.ndarray], object]) -> Damage:
    changed = Take(65).arrays["joints"]
    change(changed)
    return told(joints=changed)


def picture(name: str, image: Image.Image) -> Damage:
    return lambda folder: image.save(folder / name)


def changed(matrix: np.ndarray, place: tuple[int, int], value: float) -> np.ndarray:
    other = matrix.copy()
    other[place] = value
    return other


MOTION_CASES = {
    "torn": (truncated(NPZ), "cannot be read"),
    "flipped": (flipped(NPZ, 0.3), "cannot be read"),
    "no archive": (replaced(NPZ, b"joints"), "cannot be read"),
    "link": (linked(NPZ), "leads out of"),
    "objects": (told(room=np.array({"a": 1}, object)), "holds room of shape"),
    "no joints": (told(joints=None), "holds joints 0 times"),
    "of 16 joints": (told(joints=np.zeros((65, 16, 3))), "skeleton.yaml names 17 joints"),
    "of no frames": (told(joints=np.zeros((0, 17, 3))), r"not \(frames, 17, 3\)"),
    "whole numbers": (told(joints=np.zeros((65, 17, 3), int)), "type int64"),
    "not a number": (joints(lambda x: x[7].fill(np.nan)), "not finite, first in frame 7"),
    "far away": (joints(lambda x: x[3].__iadd__(1e6)), "from the origin in frame 3"),
    "row vectors": (told(world2cam=WORLD2CAM.T), "for row vectors"),
    "mirrored": (told(world2cam=WORLD2CAM * [[-1], [1], [1], [1]]), "whose rotation is none"),
    "stretched": (told(world2cam=np.diag([2.0, 2, 2, 1])), "whose rotation is none"),
    "3 x 4": (told(world2cam=WORLD2CAM[:3]), r"not \(4, 4\) or \(frames, 4, 4\)"),
    "fewer cameras": (told(world2cam=np.tile(WORLD2CAM, (64, 1, 1))), "64 frames, but 65 frames of joints"),
    "no focal length": (told(intrinsics=changed(INTRINSICS, (0, 0), 0)), "not in pixels"),
    "in widths": (told(intrinsics=INTRINSICS / [[COLUMNS], [ROWS], [1]]), "not in pixels"),
    "skewed": (told(intrinsics=changed(INTRINSICS, (0, 1), 3)), "fx 0 cx"),
    "transposed": (told(intrinsics=INTRINSICS.T), "fx 0 cx"),
    "of larger pictures": (told(intrinsics=INTRINSICS * [[4], [4], [1]]), "intrinsics of other pictures"),
    "infinite": (told(intrinsics=changed(INTRINSICS, (1, 1), np.inf)), "not finite"),
    "no fps": (told(fps=None), "holds fps 0 times"),
    "fps 0": (told(fps=0), "fps 0"),
    "fps in words": (told(fps="thirty"), "fps of shape"),
    "no room": (told(room=None), "holds room 0 times"),
    "empty room": (told(room=" "), "whose name has 1 letters"),
    "room 2.5": (told(room=2.5), "room of shape"),
    "shorter than its pictures": (lambda f: picture("00065.jpg", Image.open(f / COLOUR))(f), "it tells 65"),
}


@pytest.mark.parametrize(("damage", "said"), MOTION_CASES.values(), ids=MOTION_CASES)
def test_motion_that_cannot_be(whole, tmp_path, damage, said):
    message = refusal(whole, tmp_path, damage)
    assert "take0" in message and NPZ in message and re.search(said, message)


def blank(rows: int = ROWS, mode: str = "L") -> Image.Image:
    return Image.new(mode, (COLUMNS, rows))


def renamed(name: str, other: str) -> Damage:
    return lambda folder: (folder / name).rename(folder / other)


PICTURE_CASES = {
    "no colour": (missing(COLOUR), "take0", "no frame with both colour"),
    "no depth": (missing(DEPTH), "take0", "no frame with both colour"),
    "other digits": (renamed(COLOUR, "0000.jpg"), "take0", "no frame with both colour"),
    "torn colour": (truncated(COLOUR), COLOUR, "damaged"),
    "torn depth": (truncated(DEPTH), DEPTH, "damaged"),
    "torn person": (truncated(PERSON), PERSON, "damaged"),
    "link": (linked(DEPTH), DEPTH, "leads out of"),
    "twice": (picture("00000.png", blank(mode="RGB")), "00000", "as .jpg and as .png"),
    "grey": (picture(COLOUR, blank()), COLOUR, "not RGB"),
    "depth of 8 bits": (picture(DEPTH, blank()), DEPTH, "not one channel of 16 bits"),
    "depth in colours": (picture(DEPTH, blank(mode="RGB")), DEPTH, "not one channel of 16 bits"),
    "smaller depth": (picture(DEPTH, blank(40, "I;16")), DEPTH, r"\(40, 128\) pixels"),
    "smaller person": (picture(PERSON, blank(40)), PERSON, r"\(40, 128\) pixels"),
}


@pytest.mark.parametrize(("damage", "file", "said"), PICTURE_CASES.values(), ids=PICTURE_CASES)
def test_pictures_that_cannot_be(whole, tmp_path, damage, file, said):
    message = refusal(whole, tmp_path, damage)
    assert file in message and re.search(said, message)


def test_recordings_of_other_frames_a_second_are_refused_or_left_out(tmp_path):
    root = write_root(tmp_path / "root")
    told(fps=25)(root / "take1")
    with pytest.raises(SagError, match=r"take1/motion\.npz tells fps 25, unlike take0 with 30: resample one"):
        module(root, tmp_path / "cache").build()
    notes = module(root, tmp_path / "cache", skip_broken=True).build().index["notes"]
    assert any("take1 LEFT OUT, it is broken" in note for note in notes)


def test_a_folder_without_recordings_or_skeleton_says_what_belongs_there(tmp_path):
    with pytest.raises(SagError, match=r"has no skeleton\.yaml; .*--data\.init_args\.root; docs/own-data\.md"):
        module(tmp_path, tmp_path)
    write_skeleton(tmp_path)
    with pytest.raises(SagError, match=r"holds no recording: a folder with motion\.npz"):
        module(tmp_path, tmp_path).build()


@pytest.mark.parametrize("foot", FEET)
def test_a_skeleton_without_ankles_is_refused(tmp_path, foot):
    text = (write_skeleton(tmp_path) / "skeleton.yaml").read_text()
    (tmp_path / "skeleton.yaml").write_text(text.replace(foot, foot.replace("ankle", "toe")))
    with pytest.raises(SagError, match=rf"skeleton\.yaml: skeleton h36m_17 has no joint {foot}, where feet are"):
        module(tmp_path, tmp_path)


def test_a_skeleton_with_joints_that_the_files_lack_is_refused(whole, tmp_path):
    with pytest.raises(SagError, match=r"prox_16 has joints that .*root/skeleton\.yaml lacks: chest, neck, root"):
        module(whole, tmp_path, skeleton="prox_16")
