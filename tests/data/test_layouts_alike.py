"""One recording in both layouts, seen by one camera: GTA-IM's loader and PROX's read the same windows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from layouts_checks import like
from scipy.ndimage import binary_dilation, binary_erosion

from sag.data.cache import DEPTH_UNIT, PERSON
from sag.data.gta_im import GtaImDataModule
from sag.data.layouts import Script, gta_im, kinect, prox
from sag.data.layouts.script import filmed
from sag.data.prox import ProxDataModule
from sag.data.recordings import RecordedDataModule

SCRIPT = Script(rooms=1, recordings=1, seconds=70 / 30, size=(72, 128))
SIZE = (72, 128)
STARTS = (0, 5)

FOCAL = kinect.COLOUR[1, 1]
CENTRED = np.array([[FOCAL, 0, 959.5], [0, FOCAL, 539.5], [0, 0, 1]])
"""GTA-IM's cameras look through the middle of the picture, with square pixels; the Kinect's here does so as well."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording, written twice."""
    made = tmp_path_factory.mktemp("alike")
    scene = filmed(SCRIPT, 0, kinect.FIELD)
    (recording,) = scene.recordings
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(kinect, "COLOUR", CENTRED)
        matrix = kinect.colour_matrix(SCRIPT.size)
        np.testing.assert_allclose(matrix, recording.camera.intrinsics(SCRIPT.size), atol=1e-9)
        prox.write_room(made / "prox", SCRIPT, 0)
    gta_im.write_recording(made / "gta" / gta_im.FOLDER / "one", recording, scene.scenery, SCRIPT, 1, 0)
    return made


def read(module: RecordedDataModule) -> tuple[list[int], list[dict[str, np.ndarray]]]:
    """Where windows start, and some of them."""
    (path,) = module.recordings()
    recording = module.reader.read(path)
    starts, _ = module.reader.starts(recording, 1, module.form)
    return starts, [module.reader.window(recording, start, module.form, True) for start in STARTS]


@pytest.fixture(scope="module")
def options() -> dict[str, Any]:
    return {"skeleton": "prox_16", "image_size": SIZE}


@pytest.fixture(scope="module")
def gta(folder: Path, options: dict[str, Any]) -> tuple[list[int], list[dict[str, np.ndarray]]]:
    return read(GtaImDataModule(folder / "gta", **options))


@pytest.fixture(scope="module", params=["scan", "sensor"])
def other(
    request: pytest.FixtureRequest, folder: Path, options: dict[str, Any]
) -> tuple[list[int], list[dict[str, np.ndarray]]]:
    return read(ProxDataModule(folder / "prox", depth=request.param, **options))


def test_the_same_windows_can_be_used(gta, other) -> None:
    assert gta[0] == other[0] and set(STARTS) <= set(gta[0])


def test_joints_and_cameras_are_the_same(gta, other) -> None:
    for mine, its in zip(gta[1], other[1]):
        np.testing.assert_allclose(mine["joints"], its["joints"], atol=1e-4)
        for name in ("intrinsics", "cloud_intrinsics"):
            np.testing.assert_allclose(mine[name], its[name], atol=1e-2)
        # The game's world has its origin elsewhere.
        np.testing.assert_allclose(mine["world2cam"][:3, :3], its["world2cam"][:3, :3], atol=1e-6)
        place, its_place = (np.linalg.inv(window["world2cam"])[:3, 3] for window in (mine, its))
        np.testing.assert_allclose(place - its_place, gta_im.CORNER, atol=1e-6)


def test_pictures_and_people_are_the_same(gta, other) -> None:
    for mine, its in zip(gta[1], other[1]):
        difference = np.abs(mine["image"].astype(int) - its["image"])
        assert difference.mean() < 2 and (difference < 25).mean() > 0.99, "both are JPG, one of them mirrored"
        assert difference.mean() < np.abs(mine["image"].astype(int) - its["image"][:, ::-1]).mean() / 5
        person, its_person = (window["ids"] == PERSON for window in (mine, its))
        assert person.sum() > 50 and (person & its_person).sum() / (person | its_person).sum() > 0.97


def test_depth_is_the_same_within_the_steps_of_its_encodings(gta, other, request: pytest.FixtureRequest) -> None:
    measured = "sensor" in request.node.callspec.id
    for mine, its in zip(gta[1], other[1]):
        person = binary_dilation(mine["ids"] == PERSON, np.ones((3, 3)))
        inside = binary_erosion(mine["ids"] == PERSON)
        close, known = _close(mine["depth"], its["depth"], 0.05 if measured else DEPTH_UNIT)
        assert known.mean() > 0.3 and close[known & ~person].mean() > (0.95 if measured else 0.98)
        # A scan has no person: the capsules around the bones stand in.
        on_person = close if measured else _close(mine["depth"], its["depth"], 0.3)[0]
        assert on_person[known & inside].mean() > 0.9
        close, known = _close(mine["cloud_depth"], its["cloud_depth"], 0.05 if measured else DEPTH_UNIT)
        assert known.mean() > 0.3 and close[known].mean() > (0.95 if measured else 0.98)


def _close(mine: np.ndarray, its: np.ndarray, slack: float) -> tuple[np.ndarray, np.ndarray]:
    """Whether two stored depths are the same, and where both are known; a step of GTA-IM's is up to z²/900 wide."""
    a, b = mine * DEPTH_UNIT, its * DEPTH_UNIT
    return like(b, a, a**2 / 900 + slack), (mine > 0) & (its > 0)
