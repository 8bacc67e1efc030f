"""Damaged and hostile files of PROX are refused in one line that names them; nothing is run, memory stays small."""

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import hostile_files as bad
import hostile_prox as prox
import numpy as np
import pytest
from hostile_memory import little_memory
from hostile_prox import CASES, COLOUR, DEPTH, FIT, FRAME, LENS, MASK, NAME, SKELETON
from hostile_scans import SCAN, with_picture
from prox_files import StandIn, Take, module, write_root

from sag.data.cache import WindowCache
from sag.data.pictures import read_colour
from sag.data.prox import bodies
from sag.data.prox.calibration import Lens, read_world2cam
from sag.data.prox.fits import read_fit
from sag.data.prox.kinect import read_skeleton
from sag.data.prox.person import read_mask
from sag.data.prox.scan import read_triangles
from sag.data.prox.sensor import read_depth
from sag.errors import SagError
from sag.types import FRAMES

OTHER = "N0Sofa_00034_01"


@pytest.fixture(scope="session")
def whole(tmp_path_factory) -> Path:
    """A recording of one window; read once, so that what reading needs is there."""
    folder = tmp_path_factory.mktemp("whole_prox")
    root = write_root(folder / "root", ("MPH16", "N0Sofa"))
    written = Take(FRAMES).write(root, NAME, fits=True)
    for kind in ("Depth", "BodyIndexColor"):
        for path in sorted((written / kind).iterdir())[1:]:
            path.unlink()
    module(root, folder / "cache").build()
    return root


@pytest.fixture
def root(whole, tmp_path) -> Path:
    """A copy, as deep in `tmp_path` as a recording of GTA-IM, so that `outside` is the same."""
    return shutil.copytree(whole, tmp_path / "sets" / "prox" / "root", copy_function=_copied)


def _copied(source: str, target: str) -> None:
    """Copies what is written over, and links the frames that are not."""
    frame = "recordings" in source or "PROXD" in source
    (os.link if frame and FRAME not in source else shutil.copy2)(source, target)


@pytest.fixture
def build(root, tmp_path, monkeypatch) -> Callable[..., WindowCache]:
    """Reads the copy, with PROXD's fits where they are asked for."""
    monkeypatch.setitem(sys.modules, "smplx", StandIn())
    monkeypatch.setattr(bodies, "read_model", lambda path: {})
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "SMPLX_MALE.npz").touch()

    def run(fits: bool = False, **options: object) -> WindowCache:
        models = {"smplx_models": tmp_path / "models"} if fits else {}
        return module(root, tmp_path / "cache", **models, **options).build()

    return run


@pytest.mark.parametrize(("damage", "file", "options"), CASES)
def test_refused_by_name_in_one_line(root, build, tmp_path, damage, file, options):
    damage(root)
    with little_memory(), pytest.raises(SagError) as refused:
        build(**options)
    assert file in str(refused.value) and "\n" not in str(refused.value)
    assert not (tmp_path / "canary").exists()
    assert not (tmp_path / "cache").exists() or not any((tmp_path / "cache").iterdir())


@pytest.mark.parametrize("options", [{}, {"fits": True}, {"depth": "sensor"}])
def test_without_damage_nothing_is_refused(build, options):
    assert len(build(**options).index["sequences"]) == 1


def test_every_kind_of_file_is_in_the_battery(root, tmp_path):
    assert bad.canary(root) == tmp_path / "canary", "where the gadgets would put it"
    named = {case.values[1] for case in CASES}
    assert {LENS, prox.INFRARED, prox.CAMERA, SCAN, COLOUR, DEPTH, MASK, SKELETON, FIT} <= named
    assert sum("gadget" in case.id for case in CASES) == 10 and len(CASES) > 25


def test_a_picture_that_a_scan_names_is_not_opened(root, build):
    with_picture(root)
    with little_memory():
        build()


@pytest.mark.parametrize(
    ("damage", "options"),
    [
        (prox.JSON[prox.CAMERA, "singular"], {}),
        (prox.JSON[SKELETON, "deep"], {}),
        (prox.FITS["gadget_system"], {"fits": True}),
        (prox.RECORDINGS["fits_link_out"][0], {"fits": True}),
        (bad.missing(SCAN), {}),
        (bad.truncated(COLOUR), {}),
        (bad.linked(f"recordings/{NAME}"), {}),
        (prox.renamed("holiday"), {}),
        (prox.RECORDINGS["name_of_two_parts"][0], {}),
        (prox.RECORDINGS["no_picture"][0], {}),
    ],
)
def test_good_recordings_beside_a_broken_one_load_when_asked(root, build, tmp_path, capsys, damage, options):
    Take(FRAMES).write(root, OTHER, **options)
    damage(root)
    with pytest.raises(SagError, match="MPH16"):
        build(**options)
    cache = build(**options, skip_broken=True)
    assert cache.index["sequences"] == [OTHER]
    assert cache.index["dropped"] == {"broken recording": 1}
    (note,) = (note for note in cache.index["notes"] if "LEFT OUT" in note)
    assert note.startswith("MPH16_00157") and note in capsys.readouterr().out
    assert not (tmp_path / "canary").exists()


READS: dict[str, Callable[[Path], object]] = {
    LENS: Lens.read,
    prox.CAMERA: lambda path: read_world2cam(path.parents[1], path.stem),
    SCAN: read_triangles,
    COLOUR: read_colour,
    DEPTH: read_depth,
    MASK: read_mask,
    SKELETON: read_skeleton,
    FIT: read_fit,
}


@pytest.mark.parametrize("file", READS)
def test_whatever_bit_is_flipped_reading_ends_in_a_value_or_an_error_that_names_the_file(whole, tmp_path, file):
    path, random = tmp_path / file, np.random.default_rng(0)
    path.parent.mkdir(parents=True)
    original = (whole / file).read_bytes()
    refused = 0
    for _ in range(60):
        content = bytearray(original)
        content[random.integers(len(content))] ^= 1 << random.integers(8)
        path.write_bytes(content)
        try:
            READS[file](path)
        except SagError as error:
            refused += 1
            assert path.name in str(error) and "\n" not in str(error)
    assert refused
