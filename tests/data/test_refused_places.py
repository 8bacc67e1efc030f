"""Options and files that cannot work are one sentence on `sag:`, whatever a name holds."""

import io
import sys
from pathlib import Path

import pytest
from gta_im_files import Sequence

from sag.cli import main
from sag.data.base import MotionDataModule
from sag.data.gta_im import GtaImDataModule
from sag.data.known import DATA_SETS, imported
from sag.errors import SagError
from sag.files import read_yaml, writing_in

SMALL = ["--image_size=[36,64]", "--stride", "1"]


@pytest.fixture
def root(tmp_path) -> Path:
    """One recording with a few windows."""
    Sequence(66).write(tmp_path / "root" / "FPS-30" / "a", 1, pictured=range(2))
    return tmp_path / "root"


@pytest.fixture
def file(tmp_path) -> Path:
    """A file where a folder should be."""
    (tmp_path / "file").write_text("taken")
    return tmp_path / "file"


def refused(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The one sentence that a refused command says."""
    assert main([str(argument) for argument in arguments]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("sag: ")
    return said


@pytest.mark.parametrize("size", ["[0,0]", "[-3,5]", "[5,0]"])
@pytest.mark.parametrize("command", ["check", "prepare"])
def test_pictures_without_pixels(root, capsys, command, size):
    assert "image_size must be at least 1 row" in refused(capsys, "data", command, root, f"--image_size={size}")


@pytest.mark.parametrize("option", ["--out", "--data.init_args.cache_dir"])
@pytest.mark.parametrize("inside", ["", "deeper"])
def test_caches_where_a_file_lies(root, file, capsys, option, inside):
    said = refused(capsys, "data", "prepare", root, *SMALL, option, file / inside if inside else file)
    assert str(file) in said and "cannot be written" in said and "cache_dir" in said
    assert file.read_text() == "taken"


def test_rooms_where_a_file_lies(file, capsys):
    assert "cannot be written" in refused(capsys, "data", "rooms", "--cache_dir", file, "--image_size", 36, 64)


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs Linux's /proc, where nobody makes a file")
@pytest.mark.parametrize(("command", "option"), [("prepare", "--out"), ("check", "--sheet")])
def test_places_that_the_system_refuses(root, capsys, command, option):
    said = refused(capsys, "data", command, root, *SMALL, option, "/proc/x.png")
    assert "/proc/x.png" in said and "cannot be written (/proc/" in said


def test_an_error_elsewhere_keeps_its_own_name(tmp_path):
    with pytest.raises(FileNotFoundError), writing_in(tmp_path / "here", "go away"):
        (tmp_path / "there" / "absent").open()
    with pytest.raises(SagError, match="here cannot be written"), writing_in(tmp_path / "here", "go away"):
        (tmp_path / "here" / "deeper" / "absent").open("w")


@pytest.mark.parametrize(
    ("sheet", "hint"), [("x.foo", "ends in .png"), ("", "is a folder"), ("file/x.png", "is a file"), ("x", ".png")]
)
@pytest.mark.parametrize("command", ["check", "rooms"])
def test_sheets_that_cannot_be_drawn(root, file, tmp_path, capsys, command, sheet, hint):
    place = tmp_path / sheet
    if not sheet:
        place = tmp_path / "folder.png"
        place.mkdir()
    asked = ["check", root, "--sheet"] if command == "check" else ["rooms", "--cache_dir", file, "--preview"]
    said = refused(capsys, "data", *asked, place)
    assert hint in said and str(place) in said and asked[-1] in said


@pytest.mark.parametrize("count", ["-1", "0"])
@pytest.mark.parametrize("asked", [["check", "--sheet"], ["rooms", "--preview"]])
def test_sheets_of_no_window(root, tmp_path, capsys, asked, count):
    command, option = asked
    place = [root] if command == "check" else []
    said = refused(capsys, "data", command, *place, option, tmp_path / "x.png", "--count", count)
    assert f"--count must be at least 1, found {count}" in said


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ("data: {init_args: [1]}", "data.init_args"),
        ("data: [1]", "data.init_args"),
        ("[1]", "data"),
        ("5000", "data.init_args"),
        ("{", "cannot be read as YAML"),
        ("[" * 5000 + "]" * 5000, "cannot be read as YAML"),
    ],
)
def test_configs_that_are_none(root, tmp_path, capsys, content, hint):
    path = tmp_path / "config.yaml"
    path.write_text(content)
    said = refused(capsys, "data", "check", root, "--config", path)
    assert str(path) in said and hint in said and len(said) < 500
    assert str(path) in refused(capsys, "score", "motions.npz", "--reference", path)


def test_yaml_is_read(tmp_path):
    (tmp_path / "a.yaml").write_text("a: {b: [1, x]}")
    assert read_yaml(tmp_path / "a.yaml") == {"a": {"b": [1, "x"]}}


def test_names_cannot_move_the_cursor(tmp_path, capsys):
    said = refused(capsys, "data", "check", tmp_path / "a\x1b[2J\udcff")
    assert "a\\x1b[2J\\udcff is missing" in said


def test_a_terminal_that_knows_few_letters_is_no_traceback(root, tmp_path, monkeypatch):
    (root / "FPS-30" / "b\udcff会").mkdir()
    (root / "FPS-30" / "b\udcff会" / "info_frames.npz").write_bytes(b"no archive")
    shown = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", shown)
    options = [*SMALL, "--skip_broken", "true"]
    assert main(["data", "prepare", str(root), *options, "--out", str(tmp_path / "out")]) == 0
    shown.flush()
    said = shown.buffer.getvalue().decode("ascii")
    assert "b\\udcff\\u4f1a LEFT OUT" in said and "out/gta_im-" in said


@pytest.mark.parametrize("name", DATA_SETS)
def test_every_data_set_is_known_by_the_name_of_its_config(name):
    assert issubclass(imported(DATA_SETS[name]), MotionDataModule) and imported(DATA_SETS[name]).name == name


def test_the_smallest_picture_is_one_pixel(tmp_path):
    assert GtaImDataModule(tmp_path, image_size=(1, 1)).image_size == (1, 1)
