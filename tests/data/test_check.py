"""`sag data check` of GTA-IM: what it counts and what it finds."""

from pathlib import Path

import hostile_files as bad
import hostile_traps as trap
import numpy as np
import pytest
from check_reports import OPTIONS, told
from gta_im_files import Sequence
from hostile_files import COLOUR, NPZ, PICKLE, ROOM
from PIL import Image

from sag.data.check.command import main
from sag.data.check.gta_im_recording import examine
from sag.data.command import main as data
from sag.data.known import recognised
from sag.data.recordings.filters import Limits
from sag.errors import SagError

CENTIMETRES = np.where(np.arange(16).reshape(4, 4) // 4 == 3, 100, 1) - np.diag([0, 0, 0, 99])
"""Makes the translation of cameras one in centimetres."""


@pytest.fixture
def root(tmp_path) -> Path:
    """Three recordings in three rooms, one of them only tested on."""
    for name, room in (("a", 1), ("b", 2), ("c", 13)):
        Sequence(68).write(tmp_path / "root" / "FPS-30" / name, room, pictured=range(4))
    return tmp_path / "root"


def changed(root: Path, damage: bad.Damage, name: str = "b") -> Path:
    """The data set with one recording damaged."""
    damage(root / "FPS-30" / name)
    return root


# --- what is there ---


def test_a_whole_data_set_is_told_and_not_broken(root, capsys):
    assert data(["check", str(root), *OPTIONS]) == 0
    said = told(capsys)
    assert said["recordings"] == "3 (3 in FPS-30)" and said["not there"] == "FPS-5"
    assert said["rooms"] == "1 (1 recording), 2 (1 recording), 13 (1 recording)"
    assert said["frames"] == "ok 204" and said["pictures"].startswith("ok 12 frames")
    assert said["decoded"] == "ok the pictures of 12 frames" and said["broken files"] == "ok none"
    assert said["kept"] == "ok 8 train, 4 val, 4 test"
    assert (said["root teleports"], said["camera cuts"], said["camera zooms"]) == ("0", "0", "0")
    for name in ("projection", "ids", "bones", "depth", "skin"):
        assert said[name].startswith("ok"), said[name]
    assert said["ids"].startswith("ok 100.0% of ") and "5.1 cm behind" in said["skin"]


@pytest.mark.parametrize("inside", ["", "FPS-30", "FPS-30/a"])
def test_a_folder_of_a_data_set_leads_to_its_root(root, inside):
    known, found = recognised(root / inside)
    assert known.name == "gta_im" and found.resolve() == root.resolve()


def test_other_folders_are_refused_with_what_was_expected(tmp_path, root):
    (nothing := tmp_path / "nothing").mkdir()
    with pytest.raises(SagError, match="has none of FPS-30 or FPS-5 for GTA-IM; recordings or PROXD"):
        recognised(nothing)
    with pytest.raises(SagError, match="absent is missing"):
        recognised(tmp_path / "absent")
    (root / "FPS-30").rename(tmp_path / "elsewhere")
    with pytest.raises(SagError, match=r"recordings of GTA-IM: move them to .*elsewhere/FPS-30"):
        recognised(tmp_path / "elsewhere")


def test_options_are_those_of_training(root, capsys):
    assert main([str(root), "--stride", "2", "--data.init_args.train_rooms=[1]", "--pictures", "2"]) == 0
    said = told(capsys)
    assert "OTHER" not in said["kept"] and "2: room in neither train_rooms nor test_rooms" in said["dropped"]
    assert said["decoded"] == "ok the pictures of 6 frames"
    with pytest.raises(SagError, match="--pictures must be a number or all"):
        main([str(root), "--pictures", "few"])


def test_incomplete_pictures_and_other_folders_are_worth_a_look(root, capsys):
    (root / "FPS-30" / "a" / "00002_id.png").unlink()
    (root / "FPS-30" / "notes").mkdir()
    assert main([str(root), *OPTIONS]) == 0
    said = told(capsys)
    assert said["incomplete"] == "look some pictures are missing in 1 frame a: 2"
    assert said["other folders"].endswith("notes") and said["pictures"].startswith("ok 11 frames")
    assert "no picture at the start frame" in said["dropped"]


# --- what is broken ---


@pytest.mark.parametrize(
    ("damage", "file"),
    [
        (bad.truncated(NPZ), NPZ),
        (trap.pickled(PICKLE, trap.gadgets()["system"]), PICKLE),
        (bad.missing(ROOM), ROOM),
        (bad.truncated(COLOUR), COLOUR),
        (trap.cut_off, "is cut off"),
        (bad.replaced(COLOUR, b""), f"{COLOUR} is empty"),
    ],
)
def test_broken_files_are_named_and_are_status_1(root, capsys, damage, file):
    assert main([str(changed(root, damage)), *OPTIONS]) == 1
    said = told(capsys)
    assert said["broken files"].startswith("broken 1, in 1 recording ") or file.endswith("empty")
    assert file.replace(" ", "") in said["broken files"].replace(" ", "")
    assert not bad.canary(root / "FPS-30" / "b").exists()


def test_a_broken_recording_is_left_out_of_the_windows(root, capsys):
    assert main([str(changed(root, bad.truncated(NPZ))), *OPTIONS]) == 1
    said = told(capsys)
    assert said["dropped"] == "1: broken recording" and said["frames"] == "ok 136"


def test_when_all_is_broken_the_report_says_so(root, capsys):
    for name in "abc":
        changed(root, bad.truncated(NPZ), name)
    assert main([str(root), *OPTIONS]) == 1
    said = told(capsys)
    assert said["kept"] == "broken none" and said["broken files"].startswith("broken 3, in 3 recordings")


@pytest.mark.parametrize(
    ("damage", "line"),
    [
        (bad.arrays(joints_2d=lambda a: a + 3), "projection"),
        (bad.arrays(joints_3d_world=lambda a: a - [0, 0, 0.05]), "projection"),
        (bad.arrays(joints_3d_world=lambda a: 100 * a, world2cam_trans=lambda a: a * CENTIMETRES), "bones"),
    ],
)
def test_other_units_and_frames_are_broken(root, capsys, damage, line):
    for name in "abc":
        changed(root, damage, name)
    assert main([str(root), *OPTIONS]) == 1
    assert told(capsys)[line].startswith("broken")


def test_ids_of_other_pictures_do_not_agree(root, capsys):
    for folder in (root / "FPS-30").iterdir():
        for path in folder.glob("*_id.png"):
            noise = np.random.default_rng(0).integers(1, 255, (108, 192, 3), np.uint8)
            Image.fromarray(noise).save(path)
    assert main([str(root), *OPTIONS]) == 1
    assert told(capsys)["ids"].startswith("broken")


def test_broken_pictures_are_named_where_the_recording_is_broken_too(root, capsys):
    for damage in (bad.truncated(NPZ), bad.truncated(COLOUR), bad.replaced("00001.png", b"")):
        changed(root, damage)
    assert main([str(root), *OPTIONS]) == 1
    said = told(capsys)["broken files"]
    assert said.startswith("broken 3, in 1 recording FPS-30/b/00001.png is empty")
    assert f"FPS-30/b/{NPZ} cannot be read" in said and f"FPS-30/b/{COLOUR} is damaged" in said


# --- motion and cameras ---


def test_teleports_cuts_and_zooms_are_told_with_their_frames(tmp_path, capsys):
    sequence = Sequence(68)
    sequence.roots[30:] += [0.5, 0, 0]
    folder = sequence.write(tmp_path / "FPS-30" / "a")
    focal = np.ones((68, 1, 1))
    focal[40:50, 0, 0] = 1.02 ** np.arange(10)
    focal[50:] = focal[49]
    turn = np.diag([-1.0, 1, -1])

    def cut(world2cam: np.ndarray) -> np.ndarray:
        world2cam = world2cam.copy()
        world2cam[60:, :, :3] = world2cam[60:, :, :3] @ turn
        return world2cam

    zoomed = np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]) * (focal - 1) + 1
    bad.arrays(world2cam_trans=cut, intrinsics=lambda a: a * zoomed, joints_2d=lambda a: None)(folder)
    main([str(tmp_path), *OPTIONS])
    said = told(capsys)
    assert said["root teleports"] == "1, which no window goes over: by more than 0.3 m; after the frames a: 29"
    assert "between the frames a: 59 to 60, " in said["camera cuts"] and "180 degrees" in said["camera cuts"]
    assert said["camera zooms"] == "1, which drop no window; in the frames a: 40 to 49"
    assert said["projection"] == "look no recording has joints_2d to compare with"


def test_a_recording_of_no_plausible_picture_is_examined(tmp_path):
    folder = Sequence(65).write(tmp_path / "a", pictured=[0])
    trap.single(bad.DEPTH)(folder)
    (look,) = examine(folder, Limits(), None).looks
    assert (look.visible, look.on_person) == (0, 0) and np.isnan(look.gap) and np.isnan(look.depth).all()


# --- the sheet ---


def test_the_sheet_shows_windows(root, tmp_path, capsys):
    sheet = tmp_path / "sheets" / "all.png"
    assert main([str(root), *OPTIONS, "--sheet", str(sheet), "--count", "4"]) == 0
    with Image.open(sheet) as drawn:
        assert drawn.size[0] > drawn.size[1] and len(drawn.convert("RGB").getcolors(1 << 24)) > 200
    assert f"the sheet is in {sheet}" in " ".join(capsys.readouterr().out.split())


def test_without_windows_there_is_no_sheet(root, tmp_path):
    for name in "abc":
        changed(root, bad.truncated(NPZ), name)
    with pytest.raises(SagError, match="no window to draw"):
        main([str(root), "--sheet", str(tmp_path / "no.png")])
