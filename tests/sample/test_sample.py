"""`sag sample`: from photographs and from windows, what it writes and says, and what it refuses."""

import time
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from toy_runs import toy_run

from sag.cli import main
from sag.components import Components, Network
from sag.data.motion_file import read_motions
from sag.data.photo import PhotoDataModule
from sag.geometry.camera import project
from sag.methods import SAG
from sag.references import data_of
from sag.sample import command_line
from sag.sample.drawing import drawn
from sag.skeleton import GTA_IM_19


@pytest.fixture
def folder(tmp_path, toy, monkeypatch) -> Path:
    """A working folder with a run with a depth decoder, one without, and a photograph."""
    monkeypatch.chdir(tmp_path)
    for name, depth in (("md", True), ("m", False)):
        toy_run(tmp_path / name, toy, depth)
    noise = np.random.default_rng(0).integers(0, 255, (120, 200, 3), dtype=np.uint8)
    Image.fromarray(noise).save(tmp_path / "room.png")
    return tmp_path


PHOTO = ["--image", "room.png", "--start", "110,70", "--fov", "50"]


def sample(run: str, *options: str) -> np.ndarray:
    assert main(["sample", run, "--output", "out", *options]) == 0
    return read_motions(Path("out/motions.npz"), frames=None).joints


def test_a_photograph_becomes_motions_that_start_at_the_pixel(folder, capsys):
    joints = sample("md", *PHOTO, "--samples", "3", "--distance", "3.5")
    assert joints.shape == (1, 3, 65, 19, 3) and np.isfinite(joints).all()
    assert np.allclose(joints[0, :, 0], joints[0, 0, 0]) and not np.allclose(joints[0, 0], joints[0, 1])
    said = capsys.readouterr().out
    assert "200 x 120 pixels, 50° from bottom to top (as told)" in said and "3.5 m away: as told; the depth" in said
    data = data_of("out/config.predict.yaml")
    assert isinstance(data, PhotoDataModule)
    camera = torch.from_numpy(data.picture_with_camera(0)[1])[None]
    root = torch.from_numpy(joints[0, 0, 0, GTA_IM_19.root_index]).double()[None]
    assert np.allclose(project(root, camera), [[110, 70]], atol=0.02) and root[0, 2] == pytest.approx(3.5)
    assert (data.cache.depth > 0).any()


def test_what_is_unlike_the_training_is_told(folder, toy, capsys):
    sample("md", *PHOTO, "--samples", "1", "--distance", "25")
    far = capsys.readouterr().out
    sample("md", "--image", "room.png", "--start", "110,119", "--fov", "50", "--samples", "1", "--distance", "2")
    near = capsys.readouterr().out
    assert "caution: people it was trained on start" in far and "caution: the feet" not in far
    assert "caution: the feet are outside of the picture" in near


def test_the_decoder_tells_the_distance_and_without_one_it_is_assumed(folder, capsys):
    found = {run: sample(run, *PHOTO, "--samples", "1")[0, 0, 0, GTA_IM_19.root_index, 2] for run in ("md", "m")}
    said = capsys.readouterr().out
    assert found["m"] == 4.0 and "assumed, since this run has no depth decoder; give --distance" in said
    middle = np.median(data_depth("md")[16:20, 30:34])
    assert found["md"] == pytest.approx(middle, rel=0.05) and "the depth decoder's guess" in said
    # A distance that is told scales what the decoder says of the rest.
    sample("md", *PHOTO, "--samples", "1", "--distance", "6")
    assert np.median(data_depth(None)[16:20, 30:34]) == pytest.approx(6, rel=0.05)


def data_depth(run: str | None) -> np.ndarray:
    """Depth of the window that was written last, or of a run's, metres."""
    if run is not None:
        sample(run, *PHOTO, "--samples", "1")
    return data_of("out/config.predict.yaml").cache.depth[0] / 1000


def test_first_poses_come_from_files_too(folder):
    pose = np.random.default_rng(1).normal(0, 0.3, (19, 3))
    np.savez("pose.npz", joints=pose)
    joints = sample("m", *PHOTO, "--samples", "1", "--pose", "pose.npz")[0, 0, 0]
    root = GTA_IM_19.root_index
    assert np.allclose(joints - joints[root], pose - pose[root], atol=1e-5)


def test_every_format_at_once(folder, capsys):
    formats = ["html", "bvh", "glb", "gif"]
    sample("md", *PHOTO, "--samples", "2", "--frames", "9", "--orbit", *(f"--to={form}" for form in formats))
    names = {path.name for path in Path("out").iterdir()}
    assert names == {
        "motions.npz", "config.predict.yaml", "photo", "motions.html", "motions-0-1.bvh", "motions-0-2.bvh",
        "motions-0.glb", "motions-0.gif", "motions-0-orbit.gif",
    }  # fmt: skip
    assert "2 bodies in a scene of" in capsys.readouterr().out


def test_windows_of_the_data_set_with_any_number_of_frames(folder, toy, capsys):
    windows = toy.cache.rows("test").tolist()
    joints = sample("m/checkpoints/last.ckpt", "--window", str(windows[1]), "--samples", "2", "--frames", "150")
    assert joints.shape == (1, 2, 150, 19, 3) and f"test window {windows[1]} of toy" in capsys.readouterr().out
    assert np.allclose(joints[0, :, 0], toy.cache.joints[windows[1], 0], atol=1e-5)
    few = sample("m", "--window", str(windows[1]), "--samples", "2", "--frames", "9")
    assert few.shape[2] == 9
    assert main(["view", "out/motions.npz", "--out", "out/page.html"]) == 0
    assert sample("m", "--windows", "3", "--samples", "1").shape[:2] == (3, 1)


def test_a_sample_is_the_same_however_many_are_asked_for(folder):
    alone, more, other = (sample("m", *PHOTO, *o) for o in (["--samples=1"], ["--samples=3"], ["--seed=1"]))
    assert np.array_equal(alone[0, 0], more[0, 0]) and not np.allclose(alone[0, 0], other[0, 0])


def test_a_motion_takes_less_than_a_second(batch, toy):
    method = SAG(Components(), Network(width=0.25, critic_norm="layer", feature_grid=(3, 4)), image_size=(36, 64))
    method.sampler.scale.fit(toy.training_motion)
    asked = command_line.parser().parse_args(["--samples", "4", "--frames", "65"])
    drawn(method.eval(), batch[[0]], asked)
    began = time.process_time()
    drawn(method, batch[[0]], asked)
    assert (time.process_time() - began) / 4 < 1


REFUSALS = {
    "nowhere": (["--image", "nothere.png", "--fov", "50", "--start", "1,2"], "nothere.png does not exist"),
    "start": (["--image", "room.png"], "--image needs --start X,Y"),
    "words": (["--image", "room.png", "--fov", "50", "--start", "here"], "--start here must be two numbers of pixels"),
    "outside": (["--image", "room.png", "--fov", "50", "--start", "300,20"], "which has 200 x 120 pixels"),
    "lens": (["--image", "room.png", "--start", "10,20"], "room.png does not tell its lens"),
    "facing": ([*PHOTO, "--facing", "north"], "--facing north must be away, right, toward, left, or degrees"),
    "both": ([*PHOTO, "--facing", "left", "--pose", "p.npz"], "--facing turns the person who stands by default"),
    "window": ([*PHOTO, "--window", "3"], "--window is for a data set"),
    "photo": (["--fov", "50"], "--fov is for an --image"),
    "samples": (["--samples", "0"], "--samples is 0"),
    "frames": (["--frames", "1"], "--frames is 1"),
    "overlap": (["--frames", "100", "--overlap", "99"], "choose an overlap of 1 to 32"),
    "orbit": (["--orbit"], "--orbit is for films"),
    "page": (["--samples", "10", "--to", "html"], "tells 9 motions apart at most"),
    "unknown": (["--window", "0"], "--window 0 is no test window of toy"),
    "output": (["--output", "room.png"], "--output room.png is a file"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, folder, capsys):
    options, said = REFUSALS[name]
    assert main(["sample", "m", *options]) == 2
    assert said in capsys.readouterr().err
    assert not Path("samples/motions.npz").exists()


def test_refuses_a_checkpoint_without_its_config(folder, capsys):
    (folder / "m/config.fit.yaml").unlink()
    assert main(["sample", "m/checkpoints/last.ckpt"]) == 2
    assert "has no config.fit.yaml in m; give the checkpoint in the folder of its run" in capsys.readouterr().err
