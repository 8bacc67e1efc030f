"""`sag export`: what it writes and says, that it comes back, and what it refuses."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from export_motions import PlayedGlb
from PIL import Image

from sag.cli import main
from sag.data.motion_file import MotionFile, read_motions, write_motions
from sag.export import Upright, read_bvh, up_of
from sag.skeleton import GTA_IM_19


@pytest.fixture
def file(toy, tmp_path) -> Path:
    """Two samples of 70 frames for each test window of the toy data, with its config beside it."""
    rows = toy.cache.rows("test")
    joints = np.concatenate([toy.cache.joints[rows], toy.cache.joints[rows][:, :5]], axis=1)
    samples = np.stack([joints, joints + np.float32(0.05) * (np.arange(70) > 0)[:, None, None]], axis=1)
    write_motions(tmp_path / "made.npz", MotionFile(tmp_path / "made.npz", samples, rows, 30.0, "gta_im_19"))
    data = {"class_path": "toy_data.ToyDataModule", "init_args": {"cache_dir": str(toy.cache_dir)}}
    (tmp_path / "config.fit.yaml").write_text(yaml.safe_dump({"data": data}))
    return tmp_path / "made.npz"


def test_a_motion_goes_to_bvh_and_back(toy, file, capsys):
    out, window = file.with_name("out.bvh"), int(toy.cache.rows("test")[2])
    assert main(["export", str(file), "--to", str(out), "--window", str(window), "--sample", "2"]) == 0
    said = capsys.readouterr().out
    assert "place of every joint" in said and "70 frames at 30 fps" in said and "as toy tells of the camera" in said
    wanted = read_motions(file, frames=None).joints[2, 1]
    upright = Upright.at(toy.cache.joints[window, 0], GTA_IM_19, up_of(toy.cache.world2cam[window]), toy.ankle_height)
    read = read_bvh(out)
    back = upright.to_camera(read.of(GTA_IM_19)).astype(np.float32)
    again = file.with_name("again.npz")
    write_motions(again, MotionFile(again, back[None, None], np.array([window]), read.fps, "gta_im_19"))
    found = read_motions(again, frames=None)
    assert np.abs(found.joints[0, 0] - wanted).max() < 1e-4 and found.fps == pytest.approx(30)


def test_both_formats_hold_the_same_joints_and_the_scene_is_optional(file, capsys):
    bvh, glb, bare = (file.with_name(name) for name in ("out.bvh", "out.glb", "bare.glb"))
    assert main(["export", str(file), "--to", str(bvh), "--to", str(glb), "--scene", "--unit", "m"]) == 0
    assert "in a scene of" in capsys.readouterr().out
    assert main(["export", str(file), "--to", str(bare)]) == 0
    played = PlayedGlb(glb)
    assert np.abs(played.joints(GTA_IM_19) - read_bvh(bvh, unit="m").of(GTA_IM_19)).max() < 1e-4
    names = [{node.name for node in PlayedGlb(path).file.nodes} for path in (glb, bare)]
    assert names[0] - names[1] == {"scene"} and {"body", "camera", "left_ankle"} <= names[1]


def test_the_camera_of_the_file_sees_the_picture(toy, file):
    out = file.with_name("out.glb")
    main(["export", str(file), "--to", str(out)])
    played, window = PlayedGlb(out), int(toy.cache.rows("test")[0])
    lens = played.file.cameras[0].perspective
    world = np.linalg.inv(played.matrices[0, played.node("camera")])
    seen = played.joints(GTA_IM_19)[0] @ world[:3, :3].T + world[:3, 3]
    assert np.allclose(seen * [1, -1, -1], toy.cache.joints[window, 0], atol=1e-4)
    matrix, (rows, columns) = toy.cache.intrinsics[window], toy.image_size
    for corner in ((0, 0), (columns, rows)):
        across, down = np.abs((np.array(corner) - matrix[:2, 2]) / matrix[[0, 1], [0, 1]])
        assert down <= np.tan(lens.yfov / 2) + 1e-6 and across <= np.tan(lens.yfov / 2) * lens.aspectRatio + 1e-6


def test_all_motions_go_to_a_folder(toy, file, capsys):
    out = file.parent / "all"
    assert main(["export", str(file), "--to", "bvh", "--to", "glb", "--all", "--output", str(out), "--rigid"]) == 0
    windows = toy.cache.rows("test").tolist()
    assert sorted(p.name for p in out.iterdir()) == sorted(
        f"made-{w}-{k}.{form}" for w in windows for k in (1, 2) for form in ("bvh", "glb")
    )
    said = capsys.readouterr().out
    assert "16 files" in said and "8 with rotations only: bones keep one length, joints are" in said


@pytest.fixture
def short(file) -> Path:
    """The same with nine frames."""
    motions = read_motions(file, frames=None)
    write_motions(file, replace(motions, joints=motions.joints[:, :, :9]))
    return file


def test_films_of_a_sample_and_of_all_together(toy, short, capsys):
    out, window = short.parent / "films", int(toy.cache.rows("test")[0])
    assert main(["export", str(short), "--to", str(short.with_name("out.gif")), "--sample", "2"]) == 0
    assert "5 frames of the picture with the motion in it, 15 a second" in capsys.readouterr().out
    assert (
        main(["export", str(short), "--to", "gif", "--to", "glb", "--together", "--orbit", "--output", str(out)]) == 0
    )
    assert sorted(path.name for path in out.iterdir()) == [f"made-{window}-orbit.gif", f"made-{window}.glb"]
    assert "samples 1, 2: 9 frames" in capsys.readouterr().out
    with Image.open(out / f"made-{window}-orbit.gif") as film:
        assert film.n_frames == 5 and film.size == (480, 270)


def test_a_film_of_the_picture_needs_the_data_set(short, capsys):
    (short.parent / "config.fit.yaml").unlink()
    assert main(["export", str(short), "--to", str(short.with_name("out.gif"))]) == 2
    assert "name their data set by --reference, or give --orbit" in capsys.readouterr().err
    assert main(["export", str(short), "--to", str(short.with_name("out.gif")), "--orbit"]) == 0


def test_without_the_data_set_up_is_said_to_be_the_cameras(file, capsys):
    (file.parent / "config.fit.yaml").unlink()
    assert main(["export", str(file), "--to", str(file.with_name("out.glb"))]) == 0
    assert "as if it were held level" in capsys.readouterr().out
    assert main(["export", str(file), "--to", str(file.with_name("out.glb")), "--level"]) == 0
    assert "guessed from the person" in capsys.readouterr().out


REFUSALS = {
    "suffix": (["--to", "{}/out.fbx"], "out.fbx must be a path in .bvh, .glb, .mp4, .gif or .rrd"),
    "format": (["--to", "out.bvh", "--output", "{}"], "--to out.bvh must be bvh, glb, mp4, gif or rrd alone"),
    "all": (["--to", "bvh", "--all"], "name their folder by --output"),
    "window": (["--to", "{}/out.bvh", "--window", "3"], "--window 3 is not in"),
    "sample": (["--to", "{}/out.bvh", "--sample", "3"], "--sample is 3"),
    "scene": (["--to", "{}/out.bvh", "--scene"], "--scene is for a .glb file"),
    "rigid": (["--to", "{}/out.glb", "--rigid"], "--rigid is for a .bvh file"),
    "place": (["--to", "{}/made.npz/out.bvh"], "cannot be written"),
    "orbit": (["--to", "{}/out.glb", "--orbit"], "--orbit is for a .mp4 or .gif file"),
    "together": (["--to", "{}/out.bvh", "--together"], "--together is for a .glb or .mp4 or .gif or .rrd file"),
    "one person": (["--to", "{}/out.bvh", "--to", "{}/out.glb", "--together"], "a .bvh file holds one person"),
    "picture": (["--to", "{}/out.gif", "--level", "--reference", "nothing"], "--reference nothing is neither"),
    "reference": (["--to", "{}/out.bvh", "--reference", "nothing"], "--reference nothing is neither"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, file, capsys):
    options, said = REFUSALS[name]
    assert main(["export", str(file), *(option.format(file.parent) for option in options)]) == 2
    assert said in capsys.readouterr().err
    assert not list(file.parent.glob("**/out*"))


BROKEN = {
    "NaN": (lambda a: a | {"joints": a["joints"] * np.nan}, "motion 0 has coordinates that are not finite"),
    "frames": (lambda a: a | {"joints": a["joints"][:, :, :0]}, "they must be (n, t, j, 3)"),
    "joints": (lambda a: a | {"joints": a["joints"][:, :, :, :18]}, "has 18 joints, and skeleton gta_im_19 has 19"),
    "skeleton": (lambda a: a | {"skeleton": "spider"}, "no skeleton is called 'spider'"),
    "no skeleton": (lambda a: {k: v for k, v in a.items() if k != "skeleton"}, "does not tell its skeleton"),
    "no fps": (lambda a: {k: v for k, v in a.items() if k != "fps"}, "does not tell its frames a second; give --fps"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_refuses_motions(name, file, capsys):
    change, said = BROKEN[name]
    (file.parent / "config.fit.yaml").unlink()
    with np.load(file) as arrays:
        changed = change(dict(arrays))
    np.savez(file, **changed)
    out = file.with_name("out.bvh")
    assert main(["export", str(file), "--to", str(out)]) == 2
    assert said in capsys.readouterr().err and not out.exists()
    assert main(["export", str(file.with_name("none.npz")), "--to", str(out)]) == 2


def test_the_guides_python_runs(file, monkeypatch, capsys):
    guide = (Path(__file__).parents[2] / "docs/export.md").read_text()
    (shown,) = re.findall(r"```python\n(.*?)```", guide, re.DOTALL)
    file.rename(file.with_name("long.npz"))
    monkeypatch.chdir(file.parent)
    exec(shown, {})
    said = capsys.readouterr().out.split()
    assert said[:2] == ["places", "too"] and float(said[2]) < 1e-4 and Path("walk.glb").is_file()
