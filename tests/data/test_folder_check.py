"""`sag data check` and `sag data prepare` on a folder of one's own: usual mistakes of units and axes are found."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from folder_files import SKELETON, SKIN, WORLD2CAM, Take, module, write_root, write_skeleton
from PIL import Image

from sag.data.check.bodies import way_between
from sag.data.check.folder import inspect
from sag.data.check.report import Line
from sag.data.command import main
from sag.data.folder import FolderDataModule
from sag.data.known import recognised
from sag.skeleton import GTA_IM_19


@pytest.fixture
def root(tmp_path) -> Path:
    return write_root(tmp_path / "root")


def lines(root: Path, tmp_path: Path, pictures: int | None = None) -> dict[str, Line]:
    """What is said of a data set, by name."""
    report = inspect(module(root, tmp_path / "cache"), pictures).report
    return {line.name: line for section in report.sections for line in section.lines}


def test_what_is_there_is_told(root, tmp_path):
    (root / "elsewhere").mkdir()
    (root / "take0/00003_depth.png").unlink()
    (root / "take1/00002_person.png").unlink()
    said = lines(root, tmp_path)
    assert {name: said[name].value for name in ("recordings", "skeleton", "rooms", "frames", "pictures", "person")} == {
        "recordings": "3 with a motion.npz",
        "skeleton": "h36m_17: 17 joints, pelvis is the root",
        "rooms": "attic: 1, kitchen: 1, study: 1 (name: recordings)",
        "frames": "210, 30 a second",
        "pictures": "17 frames with colour and depth",
        "person": "told in 16 frames; in the others sought by the bones",
    }
    assert said["other folders"].details == ("elsewhere",) and said["incomplete"].details == ("take0: 3",)
    assert said["kept"].value == "11 train, 5 val, 6 test" and said["decoded"].value == "the pictures of 17 frames"
    assert {said[name].verdict for name in ("broken files", "world", "camera", "depth", "on person")} == {"ok"}
    assert lines(root, tmp_path, pictures=1)["decoded"].value == "the pictures of 3 frames"


def test_joints_lie_behind_what_is_seen(root, tmp_path):
    (centimetres,) = re.findall(r"joints are (\d+) cm behind", lines(root, tmp_path)["depth"].value)
    assert abs(int(centimetres) - 100 * SKIN) <= 1


def test_broken_files_are_named(root, tmp_path):
    (root / "take0/motion.npz").write_bytes(b"nothing")
    (root / "take1/00001.jpg").write_bytes(b"nothing")
    broken = lines(root, tmp_path)["broken files"]
    assert broken.value == "2, in 2 recordings" and broken.verdict == "broken"
    assert "take0/motion.npz" in broken.details[0] and "take1/00001.jpg" in broken.details[1]


def y_up(root: Path) -> None:
    """Turns the world so that y is up, and the camera with it."""
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    change(root, lambda arrays: {
        "joints": arrays["joints"] @ turn.T,
        "world2cam": np.block([[WORLD2CAM[:3, :3] @ turn.T, WORLD2CAM[:3, 3:]], [np.zeros((1, 3)), np.ones((1, 1))]]),
    })  # fmt: skip


def cam2world(root: Path) -> None:
    change(root, lambda arrays: {"world2cam": np.linalg.inv(arrays["world2cam"])})


def centimetres(root: Path) -> None:
    change(root, lambda arrays: {"joints": 100 * arrays["joints"]})


def depth_in_fifths(root: Path) -> None:
    """Depth pictures of 5000 steps a metre, as some sensors store them."""
    for path in root.glob("*/*_depth.png"):
        Image.fromarray((5 * np.asarray(Image.open(path)).astype(int)).astype(np.uint16)).save(path)


def masks_upside_down(root: Path) -> None:
    for path in root.glob("*/*_person.png"):
        Image.fromarray(np.asarray(Image.open(path))[::-1]).save(path)


def change(root: Path, changed) -> None:
    for path in root.glob("*/motion.npz"):
        with np.load(path) as told:
            arrays = dict(told)
        np.savez(path, **{**arrays, **changed(arrays)})


MISTAKES = [
    (y_up, "world", "look"),
    (cam2world, "camera", "broken"),
    (centimetres, "bones", "broken"),
    (depth_in_fifths, "depth", "broken"),
    (masks_upside_down, "on person", "look"),
]


@pytest.mark.parametrize(("mistake", "line", "verdict"), MISTAKES)
def test_mistakes_of_axes_and_units_are_found(root, tmp_path, mistake, line, verdict):
    before = lines(root, tmp_path)[line].verdict
    mistake(root)
    assert lines(root, tmp_path)[line].verdict == verdict != before


def test_without_a_head_nobodys_height_is_judged(tmp_path):
    def renamed(value):
        return "brow" if value == "head" else value

    skeleton = {**SKELETON, "joints": list(map(renamed, SKELETON["joints"]))}
    skeleton["bones"] = [list(map(renamed, bone)) for bone in SKELETON["bones"]]
    skeleton["parts"] = {name: list(map(renamed, members)) for name, members in SKELETON["parts"].items()}
    write_skeleton(tmp_path, **skeleton)
    Take(65).write(tmp_path / "take0", pictured=[0])
    assert lines(tmp_path, tmp_path)["bones"].verdict == "look"


def test_ways_along_the_bones():
    def way(start: str, end: str) -> list[str]:
        return [GTA_IM_19.joints[place] for place in way_between(GTA_IM_19, start, end)]

    assert way("right_wrist", "head") == ["right_wrist", "right_elbow", "right_shoulder", "neck", "head"]
    assert way("spine1", "right_knee") == ["spine1", "spine2", "spine3", "root", "right_hip", "right_knee"]
    assert way("root", "root") == ["root"]


def test_the_commands_know_it(root, tmp_path, capsys):
    assert recognised(root / "take0")[0].name == recognised(root)[0].name == "folder"
    assert main(["check", str(root), "--image_size=[36,64]", "--stride", "1"]) == 0
    assert "Own data in" in capsys.readouterr().out
    small = ["--image_size=[36,64]", "--stride", "1", "--out", str(tmp_path / "out")]
    assert main(["prepare", str(root), *small, "--test_rooms", "[kitchen]"]) == 0
    words = shlex.split(capsys.readouterr().out.split("sag run")[1].replace("\\\n", ""))
    told = dict(word.removeprefix("--data.init_args.").split("=") for word in words if "=" in word)
    assert told["skeleton"] == str(root / "skeleton.yaml") and told["test_rooms"] == '["kitchen"]'
    assert words[words.index("configs/data/folder.yaml") - 1] == "--config"
    (folder,) = (tmp_path / "out").iterdir()
    same = FolderDataModule(
        root, skeleton=told["skeleton"], test_rooms=("kitchen",), stride=1, image_size=(36, 64), cache_dir=folder.parent
    )
    assert same.build().folder == folder
