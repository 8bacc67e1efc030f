"""Rooms in PROX's layout: every file is as in the data set, and its loader reads the same windows as the rooms'."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from layouts_checks import like, trains_and_tests, write_by_command
from PIL import Image
from scipy.ndimage import binary_dilation, binary_erosion, maximum_filter, minimum_filter
from scipy.spatial.transform import Rotation

from sag.cli import main
from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.gta_im.recording import joint_places
from sag.data.layouts import Script
from sag.data.layouts.gta_im import with_clavicles
from sag.data.layouts.kinect import FIELD, INFRARED, SHIFT, TURN, colour_matrix
from sag.data.layouts.prox import SCENES, frame_name
from sag.data.layouts.script import FilmedRoom, filmed
from sag.data.prox import ProxDataModule
from sag.data.rooms.render import render
from sag.data.rooms.windows import stored_window
from sag.skeleton import PROX_16

FRAMES = 70
SCRIPT = Script(rooms=2, recordings=1, seconds=FRAMES / 30, size=(72, 128))
SIZE = (36, 64)
KINDS = {
    "Color": "jpg", "Depth": "png", "BodyIndex": "png", "BodyIndexColor": "png", "Infrared": "png", "Skeleton": "json",
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two rooms, written by the command."""
    made = tmp_path_factory.mktemp("layouts") / "prox"
    write_by_command("prox", made, SCRIPT.size, seconds=SCRIPT.seconds)
    return made


@pytest.fixture(scope="module")
def scenes() -> dict[str, FilmedRoom]:
    """What was filmed, as the rooms know it."""
    return {SCENES[number]: filmed(SCRIPT, number, FIELD) for number in range(SCRIPT.rooms)}


@pytest.fixture(scope="module")
def module(folder: Path) -> ProxDataModule:
    data = ProxDataModule(folder, cache_dir=folder.parent / "cache", image_size=SIZE)
    data.setup()
    return data


def unmirrored(folder: Path, scene: str, kind: str, frame: int) -> np.ndarray:
    path = folder / "recordings" / f"{scene}_00034_01" / kind / f"{frame_name(1 + SCENES.index(scene), frame)}"
    with Image.open(f"{path}.{KINDS[kind]}") as picture:
        return np.asarray(picture)[:, ::-1]


# --- the files ---


def test_the_folder_is_laid_out_as_the_data_set(folder: Path) -> None:
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*.*") if "recordings" not in path.parts}
    assert files == {
        "calibration/Color.json", "calibration/IR.json", "cam2world/MPH8.json", "cam2world/MPH16.json",
        "scenes/MPH8.ply", "scenes/MPH16.ply",
    }  # fmt: skip
    assert sorted(p.name for p in (folder / "recordings").iterdir()) == ["MPH16_00034_01", "MPH8_00034_01"]
    for recording in (folder / "recordings").iterdir():
        found = {kind.name: {path.name for path in kind.iterdir()} for kind in recording.iterdir()}
        number = 1 + SCENES.index(recording.name.split("_")[0])
        stems = [frame_name(number, frame) for frame in range(FRAMES)]
        assert found == {kind: {f"{stem}.{end}" for stem in stems} for kind, end in KINDS.items()}


def test_frames_are_named_by_number_and_time() -> None:
    assert frame_name(1, 0) == "s001_frame_00001__00.00.00.029"
    assert frame_name(2, 30) == "s002_frame_00031__00.00.01.029"
    assert frame_name(1, 30 * 3725) == "s001_frame_111751__01.02.05.029"


def test_twelve_scenes_of_which_any_two_train_and_test() -> None:
    assert len(set(SCENES)) == 12
    assert {"MPH16", "N3OpenArea"} < set(SCENES[:4]) and SCENES[1] == "MPH16"


def test_pictures_are_mirrored_and_those_of_the_rooms(folder: Path, scenes: dict[str, FilmedRoom]) -> None:
    for name, scene in scenes.items():
        recording, frame = scene.recordings[0], 7
        drawn = render(
            scene.scenery.with_person(recording, frame), recording.camera, colour_matrix(SCRIPT.size), SCRIPT.size
        )
        colour = unmirrored(folder, name, "Color", frame).astype(int)
        assert np.abs(colour - drawn.image).mean() < 5 < np.abs(colour[:, ::-1] - drawn.image).mean()  # JPG
        assert np.array_equal(unmirrored(folder, name, "BodyIndexColor", frame), np.where(drawn.ids == PERSON, 0, 255))


def test_measured_depth_agrees_with_the_colour_camera_by_the_calibration(
    folder: Path, scenes: dict[str, FilmedRoom]
) -> None:
    """By the recipe of the data set's tools: pixels are unprojected, moved to the colour camera and projected."""
    colour, infrared = (json.loads((folder / "calibration" / f"{n}.json").read_text()) for n in ("Color", "IR"))
    np.testing.assert_allclose(infrared["camera_mtx"], INFRARED)
    np.testing.assert_allclose(colour["view_mtx"], np.column_stack([Rotation.from_rotvec(TURN).as_matrix(), SHIFT]))
    for name, scene in scenes.items():
        depth = unmirrored(folder, name, "Depth", 0) / 8000
        body = unmirrored(folder, name, "BodyIndex", 0) == 0
        assert depth.shape == body.shape == (424, 512) and 0 < depth.max() < 8
        rows, columns = np.nonzero(depth)
        metres = depth[rows, columns]
        rays = np.stack([columns, rows, np.ones_like(rows)], axis=-1) @ np.linalg.inv(infrared["camera_mtx"]).T
        points = rays * metres[:, None] @ np.array(colour["view_mtx"])[:, :3].T + np.array(colour["view_mtx"])[:, 3]
        pixels = points @ np.array(colour["camera_mtx"]).T
        column, row = np.rint(pixels[:, :2] / pixels[:, 2:]).astype(int).T
        shown = (column >= 0) & (column < SCRIPT.size[1]) & (row >= 0) & (row < SCRIPT.size[0])
        stand = scene.scenery.with_person(scene.recordings[0], 0)
        drawn = render(stand, scene.recordings[0].camera, colour_matrix(SCRIPT.size), SCRIPT.size)
        low, high = (
            f(drawn.depth * DEPTH_UNIT, 3)[row[shown], column[shown]] for f in (minimum_filter, maximum_filter)
        )
        z = points[shown, 2]
        assert shown.mean() > 0.5 and ((z > low - 0.05) & (z < high + 0.05)).mean() > 0.97
        near = binary_dilation(drawn.ids == PERSON, np.ones((3, 3)))[row[shown], column[shown]]
        assert body.any() and near[body[rows, columns][shown]].mean() > 0.99


def test_the_scan_is_the_room_without_the_person_in_colour(folder: Path, scenes: dict[str, FilmedRoom]) -> None:
    for name, scene in scenes.items():
        mesh = trimesh.load(folder / "scenes" / f"{name}.ply", process=False)
        size = np.array(scene.room.size)
        assert np.ptp(mesh.vertices, axis=0) == pytest.approx(size + [0.2, 0.2, 0.1], abs=0.25)
        assert len(np.unique(mesh.visual.vertex_colors, axis=0)) > 5
        cam2world = np.array(json.loads((folder / "cam2world" / f"{name}.json").read_text()))
        camera = scene.recordings[0].camera
        np.testing.assert_allclose(cam2world @ camera.world2cam, np.eye(4), atol=1e-12)


def test_skeletons_have_25_joints(folder: Path) -> None:
    path = next((folder / "recordings").glob("MPH8_*/Skeleton/*_00001__*.json"))
    (body,) = json.loads(path.read_text())["Bodies"]
    joints = body["Joints"]
    assert [joint["JointType"] for joint in joints.values()] == list(range(25))
    assert sum(joint["TrackingState"] == 2 for joint in joints.values()) == 16
    place = {name: np.array([joint["Position"][axis] for axis in "XYZ"]) for name, joint in joints.items()}
    assert place["Head"][1] > place["SpineBase"][1] > place["AnkleLeft"][1]  # y up
    assert np.linalg.norm(place["HandTipLeft"] - place["WristLeft"]) == pytest.approx(0.16)


# --- the same window ---


def test_a_window_is_the_same_through_the_loader_and_from_the_rooms(
    scenes: dict[str, FilmedRoom], module: ProxDataModule
) -> None:
    cache, kept = module.cache, joint_places(PROX_16)
    assert len(cache.rows("train")) >= 2 and len(cache.rows("test")) >= 2
    for row in range(len(cache)):
        scene = scenes[cache.index["sequences"][cache.sequence[row]].split("_")[0]]
        truth = stored_window(scene.recordings[0], scene.scenery, int(cache.start[row]), SIZE)
        np.testing.assert_allclose(cache.joints[row], with_clavicles(truth["joints"])[:, kept], atol=1e-4)
        np.testing.assert_allclose(cache.intrinsics[row], truth["intrinsics"], rtol=5e-4, atol=0.01)
        np.testing.assert_allclose(cache.world2cam[row], truth["world2cam"], atol=1e-9)
        person = truth["ids"] == PERSON
        seen = binary_erosion(cache.depth[row] > 0)  # beyond the native picture nothing is known
        assert seen.mean() > 0.4
        assert like(cache.ids[row] == PERSON, person)[seen].mean() > 0.99
        assert like(cache.image[row], truth["image"], 6)[seen].mean() > 0.95
        # The scan has no person: depth there is the capsules' around the joints.
        room = seen & ~binary_dilation(person, np.ones((3, 3)))
        metres = cache.depth[row] * DEPTH_UNIT
        assert like(metres, truth["depth"] * DEPTH_UNIT, 2 * DEPTH_UNIT)[room].mean() > 0.97
        assert np.abs(metres - truth["depth"] * DEPTH_UNIT)[binary_erosion(person) & seen].max(initial=0) < 0.3


def test_the_sensors_depth_is_that_of_the_rooms_with_the_person(
    folder: Path, scenes: dict[str, FilmedRoom], module: ProxDataModule
) -> None:
    cache = ProxDataModule(folder, depth="sensor", cache_dir=module.cache_dir, image_size=SIZE).build()
    for row in range(len(cache)):
        scene = scenes[cache.index["sequences"][cache.sequence[row]].split("_")[0]]
        truth = stored_window(scene.recordings[0], scene.scenery, int(cache.start[row]), SIZE)
        metres = cache.depth[row] * DEPTH_UNIT
        seen = binary_erosion(metres > 0)
        assert seen.mean() > 0.3
        assert like(metres, truth["depth"] * DEPTH_UNIT, 0.05)[seen].mean() > 0.95
        assert like(metres, truth["depth"] * DEPTH_UNIT, 0.05)[seen & (truth["ids"] == PERSON)].mean() > 0.9


def test_the_default_split_trains_and_tests(folder: Path, module: ProxDataModule, tmp_path: Path) -> None:
    assert trains_and_tests("prox.yaml", folder, module, tmp_path)


def test_pictures_are_of_every_frame(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["data", "rooms", "--layout", "prox", str(tmp_path / "new"), "--every", "5"]) == 2
    assert "--every must be 1 for prox" in capsys.readouterr().err
