"""`sag data check`: what it counts, what it finds, and how it stands on 80 columns."""

from pathlib import Path

import hostile_files as bad
import hostile_traps as trap
import numpy as np
import prox_files
import pytest
from gta_im_files import Sequence, body
from hostile_files import COLOUR, NPZ, PICKLE, ROOM
from PIL import Image
from rich.console import Console

from sag.data.check.bodies import Bones, bones_line, bones_of
from sag.data.check.command import main
from sag.data.check.recordings import LIMBS, WAY, examine
from sag.data.check.report import Line, Report, Section, graded, plain, show
from sag.data.command import main as data
from sag.data.gta_im.recording import JOINTS
from sag.data.known import recognised
from sag.data.recordings.filters import Limits
from sag.errors import SagError

CENTIMETRES = np.where(np.arange(16).reshape(4, 4) // 4 == 3, 100, 1) - np.diag([0, 0, 0, 99])
"""Makes the translation of cameras one in centimetres."""

OPTIONS = ["--image_size=[54,96]", "--stride", "1"]


@pytest.fixture
def root(tmp_path) -> Path:
    """Three recordings in three rooms, one of them only tested on."""
    for name, room in (("a", 1), ("b", 2), ("c", 13)):
        Sequence(68).write(tmp_path / "root" / "FPS-30" / name, room, pictured=range(4))
    return tmp_path / "root"


def told(capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """What a report says, by the name of the line: value and details in one."""
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    said: dict[str, str] = {}
    name = ""
    for line in lines:
        if line[:6].strip() in ("", "ok", "look", "broken") and len(line) > 7:
            name = line[7:22].strip() or name
            said[name] = f"{said.get(name, '')} {line[:6].strip()} {line[23:].strip()}".strip()
    return {name: " ".join(value.split()) for name, value in said.items()}


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
    with pytest.raises(SagError, match="has none of FPS-30 or FPS-5 for GTA-IM; recordings or PROXD"):
        recognised(tmp_path.parent)
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
    assert said["incomplete"] == "look 1 frames lack some of their pictures a: 2"
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
    assert said["broken files"].startswith("broken 1, in 1 recordings") or file.endswith("empty")
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


def test_bones_are_measured():
    joints = np.tile(body(), (4, 1, 1))
    joints[2, JOINTS.index("left_wrist")] += [0, 0, 0.03]
    joints[3, 0] = np.nan
    bones = bones_of(joints, LIMBS, WAY)
    assert bones.stature == pytest.approx(0.15 + 0.2 + 4 * 0.1 + 0.1 + 0.4 + 0.4) and bones.plausible
    assert bones.stray == pytest.approx(0.03, abs=1e-9)
    assert bones_of(joints[3:], LIMBS, WAY) is None
    assert bones_line([("a", bones)]).verdict == "look"
    tiny = Bones(1e-4, 5e-4, 1.6e-3, 0.0)
    assert bones_line([("a", bones), ("b", tiny)]).details == ("b: 0.0016",)


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


# --- the report ---


def test_the_verdict_names_what_is_unusual():
    lines = (Line("a", "1", "ok"), Line("b", "2", "look"), Line("b", "3", "look"))
    assert Report("x", (Section("s", lines),)).verdict == "nothing is broken; worth a look: b"
    assert Report("x", (Section("s", (*lines, Line("c", "4", "broken"))),)).verdict == "BROKEN: c"
    assert [graded(v, 1, 2) for v in (1, 2, 2.1)] == ["ok", "look", "broken"]


def test_names_cannot_move_the_cursor_and_details_are_few():
    assert plain("a\x1b[2Jb\n会\udcff") == "a\\x1b[2Jb\\n会\\udcff"
    console = Console(width=80, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    show(Report("[red]x", (Section("s", (Line("[b]", "v", "", tuple(f"\x07{n}" for n in range(20))),)),)), console)
    said = console.export_text()
    assert "and 12 more" in said and "\x07" not in said and "[red]x" in said and "[b]" in said


# --- PROX ---


def test_prox_is_recognised_and_told(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root")
    for name in ("N0Sofa_00034_01", "MPH16_00157_01"):
        prox_files.Take(66).write(root, name)
    assert main([str(root), *OPTIONS, "--skeleton", "prox_16"]) == 0
    said = told(capsys)
    assert said["scenes"] == "MPH16 (1 recording), N0Sofa (1 recording)" and said["scans"] == "ok of every scene"
    assert said["frames"] == "ok 132" and said["Skeleton"] == "ok 132 files"
    assert said["bodies"].startswith("look the Kinect's skeletons") and said["bones"].startswith("ok")
    assert said["kept"].startswith("ok")


def test_what_prox_lacks_is_told(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root")
    folder = prox_files.Take(66).write(root, "N0Sofa_00034_01")
    for path in list((folder / "Depth").iterdir())[:5]:
        path.unlink()
    (root / "cam2world" / "N0Sofa.json").unlink()
    assert main([str(root), *OPTIONS]) == 1
    said = told(capsys)
    assert "fewer than colour in 1 recordings" in said["Depth"] and "61 of 66" in said["Depth"]
    assert said["cam2world"].startswith("broken missing for 1 scenes") and "N0Sofa.json" in said["broken files"]
