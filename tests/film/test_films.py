"""Films: bodies are where joints project, hidden ones are faint, and files hold what was drawn."""

import subprocess
import sys

import numpy as np
import pytest
import torch
from film_stages import INTRINSICS, SIZE, stage
from PIL import Image

from sag.errors import SagError
from sag.film import orbit_frames, overlay_frames, strip, write_film
from sag.film.canvas import Canvas
from sag.film.encoding import every_frame
from sag.film.eye import Eye
from sag.film.orbit import SWING, orbit_eye
from sag.film.place import PlaceView
from sag.film.rrd import write_rrd
from sag.film.strip import side_by_side
from sag.geometry.camera import project


def changed(frame: np.ndarray) -> np.ndarray:
    """Pixels that are not the grey of the picture."""
    return (np.abs(frame.astype(int) - 120) > 12).any(axis=-1)


def test_bodies_are_where_their_joints_project():
    shown = stage()
    frames = list(overlay_frames(shown))
    assert len(frames) == 9 and frames[0].shape == (*SIZE, 3)
    for frame in (0, 8):
        seen = project(torch.from_numpy(shown.motions[:, frame]), torch.from_numpy(INTRINSICS).expand(2, 3, 3)).numpy()
        inside = seen.reshape(-1, 2)[((seen > 0) & (seen < SIZE[::-1])).all(-1).reshape(-1)].astype(int)
        assert changed(frames[frame])[inside[:, 1], inside[:, 0]].all()
        assert changed(frames[frame]).mean() < 0.25


def test_each_sample_has_its_colour():
    (frame, *_) = overlay_frames(stage())
    blue, orange = frame[:, :80].reshape(-1, 3).astype(int), frame[:, 80:].reshape(-1, 3).astype(int)
    assert ((blue[:, 2] - blue[:, 0]) > 60).sum() > 100 and ((orange[:, 0] - orange[:, 2]) > 60).sum() > 100


def test_who_stands_behind_a_wall_is_faint():
    before, behind = (changed(next(overlay_frames(stage(1, near=near)))).sum() for near in (4.0, 6.0))
    strong = [np.abs(next(overlay_frames(stage(1, near=near))).astype(int) - 120).max() for near in (4.0, 6.0)]
    assert before > 200 and behind > 50 and strong[1] < 0.6 * strong[0]


def test_in_a_strip_too():
    before, behind = (strip(stage(1, near=near), columns=160, poses=3) for near in (4.0, 6.0))
    assert changed(before).sum() > 200 and changed(behind).sum() > 50
    assert np.abs(behind.astype(int) - 120).max() < 0.6 * np.abs(before.astype(int) - 120).max()


def test_the_nearer_body_is_seen():
    shown = stage(1)
    canvas = Canvas(Eye.of_picture(INTRINSICS, SIZE), shown.up)
    red, green = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
    for depth, colour in ((3.0, red), (2.5, green), (4.0, red)):
        place = np.array([[0.0, 0, depth]])
        canvas.add(place, place + [0.3, 0, 0], np.array([[0.1, 0.1]]), colour)
    made = canvas.laid_over(np.zeros((*SIZE, 3)))
    assert made[45, 82, 1] > 0.3 > made[45, 82, 0]
    canvas = Canvas(Eye.of_picture(INTRINSICS, SIZE), shown.up)
    canvas.add(np.array([[0.0, 0, -2]]), np.array([[0.0, 0, 1]]), np.array([[0.1, 0.1]]), red)  # through the eye
    assert not canvas.laid_over(np.zeros((*SIZE, 3))).any()


def test_the_eye_that_swings_sees_everybody_and_comes_back():
    shown = stage(3)
    assert len(list(orbit_frames(shown, (54, 96), every=4))) == 3
    for angle in (0.0, SWING, -SWING):
        eye = orbit_eye(shown, (540, 960), angle)
        seen = eye.seen(shown.motions.reshape(-1, 3))
        pixels = seen @ eye.intrinsics.T
        pixels = pixels[:, :2] / pixels[:, 2:]
        assert (seen[:, 2] > 0).all() and ((pixels > 0) & (pixels < [960, 540])).all()
        assert eye.turn[0] @ shown.up == pytest.approx(0, abs=1e-9)  # level


def test_a_wall_hides_nobody_from_behind():
    shown = stage()
    place, behind = PlaceView(shown), np.array([0.0, 0, 9.0])
    back = Eye.looking_at(np.array([0.0, 0, 5.0]), behind, shown.up, (54, 96), 0.7)
    front = Eye.looking_at(np.array([0.0, 0, 5.0]), np.zeros(3), shown.up, (54, 96), 0.7)
    assert np.isinf(place.depth(back)).all() and np.allclose(place.depth(front), 5)
    seen = place.seen_by(front)
    assert np.allclose(seen.colour, 120 / 255, atol=0.01) and np.allclose(seen.depth, 5)


def test_without_a_picture_there_is_a_floor_and_no_overlay():
    shown = stage(with_picture=False)
    frame = next(orbit_frames(shown, (54, 96)))
    assert frame.shape == (54, 96, 3) and frame.std() > 3
    with pytest.raises(SagError, match="name their data set by --reference, or give --orbit"):
        next(overlay_frames(shown))


def test_a_strip_has_every_pose_in_its_colour():
    made = strip(stage(1, frames=65), columns=160, poses=3)
    tones = made.reshape(-1, 3).astype(int)
    dark = (tones[:, 2] - tones[:, 1] > 60) & (tones[:, 1] < 90)
    bright = (tones[:, 0] > 150) & (tones[:, 1] > 130) & (tones[:, 2] < 90)
    assert dark.sum() > 50 and bright.sum() > 50
    sheet = side_by_side([made, made], columns=64)
    assert sheet.size == (2 * 64 + 4, 36) and np.asarray(sheet)[0, 65].tolist() == [255, 255, 255]


def test_an_mp4_is_read_back(tmp_path):
    reader = pytest.importorskip("imageio_ffmpeg")
    path, frames = tmp_path / "a.mp4", list(overlay_frames(stage()))
    write_film(path, iter(frames), 30.0)
    played = reader.read_frames(str(path))
    about = next(played)
    assert about["size"] == SIZE[::-1] and about["fps"] == 30
    found = [np.frombuffer(frame, np.uint8).reshape(*SIZE, 3) for frame in played]
    assert len(found) == len(frames)
    assert all(np.abs(a.astype(int) - b).mean() < 6 for a, b in zip(found, frames))
    assert [left.name for left in tmp_path.iterdir()] == ["a.mp4"]


def test_a_gif_keeps_time_and_vivid_colours(tmp_path):
    path, shown = tmp_path / "a.gif", stage(2, frames=31)
    every = every_frame(path, 30.0)
    frames = list(overlay_frames(shown, every=every))
    vivid = np.stack([shown.colour(number) for number in range(2)])
    write_film(path, iter(frames), 30.0 / every, vivid)
    with Image.open(path) as film:
        assert film.n_frames == len(frames) == 16 and film.info["loop"] == 0
        pauses = []
        for place in range(film.n_frames):
            film.seek(place)
            pauses.append(film.info["duration"])
        assert sum(pauses) == pytest.approx(1000 * 16 / 15, abs=11)
        assert np.abs(np.asarray(film.convert("RGB")).astype(int) - frames[-1]).max() < 90


def test_refuses(tmp_path, monkeypatch):
    frames = list(overlay_frames(stage(1, frames=2)))
    with pytest.raises(SagError, match=r"must be a file that ends in \.mp4 or \.gif"):
        write_film(tmp_path / "a.avi", frames, 30.0)
    (tmp_path / "file").write_text("")
    with pytest.raises(SagError, match="cannot be written"):
        write_film(tmp_path / "file/a.gif", frames, 30.0)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(SagError, match="the extra `video`"):
        write_film(tmp_path / "a.mp4", frames, 30.0)
    broken = stage(1).motions.copy()
    broken[0, 1, 2] = np.nan
    with pytest.raises(SagError, match="right_shoulder in frame 1 is at no finite place"):
        type(stage())(broken, stage().skeleton, 30.0, stage().upright)


def test_a_recording_for_rerun_is_read_back(tmp_path, monkeypatch):
    pytest.importorskip("rerun", reason="rerun-sdk is not installed: the extra `rerun`")
    write_rrd(tmp_path / "a.rrd", stage(2, frames=3), "a")
    assert [left.name for left in tmp_path.iterdir()] == ["a.rrd"]
    command = [sys.executable, "-m", "rerun", "rrd", "print", str(tmp_path / "a.rrd")]
    told = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    for entity in ("/sample_1/joints", "/sample_2/bones", "/scene", "/camera/picture"):
        assert entity in told
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(SagError, match="the extra `rerun`"):
        write_rrd(tmp_path / "b.rrd", stage(2, frames=3), "b")
