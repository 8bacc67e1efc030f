import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from prox_files import COLUMNS, ROWS, SIZE, Take, module, write_root

from sag.data.prox import ProxDataModule
from sag.data.recordings import filters as why
from sag.data.recordings.filters import Limits
from sag.errors import SagError
from sag.types import FRAMES

TRAINED, TESTED = "N0Sofa_00034_01", "MPH16_00157_01"


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A data set of two scenes with a recording each."""
    root = write_root(tmp_path_factory.mktemp("prox") / "root")
    for name in (TRAINED, TESTED):
        Take().write(root, name)
    return root


@pytest.fixture(scope="module")
def built(whole) -> ProxDataModule:
    data = module(whole, whole.parent / "cache")
    data.setup()
    return data


@pytest.fixture
def root(whole, tmp_path) -> Path:
    """A copy that a test may damage."""
    return Path(shutil.copytree(whole, tmp_path / "root"))


# --- it runs ---


def test_batches_have_their_shapes(built):
    batch = next(iter(built.test_dataloader()))
    assert batch.motion.joints.shape == (2, FRAMES, 16, 3)
    assert batch.scene.image.shape == (2, 3, *SIZE)
    assert batch.scene.depth.shape == batch.scene.person.shape == (2, *SIZE)
    assert batch.cloud.depth.shape == (2, ROWS, COLUMNS)
    assert next(iter(built.val_dataloader())).cloud is None
    assert built.fps == 30 and built.training_motion.joints.shape == (2, FRAMES, 16, 3)


def test_scenes_split_by_their_whole_names(built):
    cache = built.cache
    assert cache.index["rooms"] == ["MPH16", "N0Sofa"]
    assert cache.index["sequences"] == [TESTED, TRAINED]
    rooms = {split: cache.scene[cache.rows(split)].tolist() for split in ("train", "test")}
    assert rooms == {"train": [1, 1], "test": [0, 0]}
    assert cache.start[cache.rows("test")].tolist() == [0, 5]
    assert not any("SPLIT BY RECORDING" in note for note in cache.index["notes"])


def test_scenes_that_begin_alike_are_told_apart(tmp_path):
    names = ("MPH1Library_00034_01", "MPH11_00034_01", "MPH112_00034_01", "MPH16_00157_01", "Kitchen_00001_01")
    root = write_root(tmp_path / "root", tuple(name.split("_")[0] for name in names))
    for name in names:
        Take(FRAMES).write(root, name)
    cache = module(root, tmp_path, cloud_step=4).build()
    kept = {cache.index["rooms"][room] for room in cache.scene.tolist()}
    assert kept == {"MPH1Library", "MPH11", "MPH112", "MPH16"}
    assert cache.index["dropped"] == {why.OTHER_ROOM: 1}
    assert {cache.index["rooms"][room] for room in cache.scene[cache.rows("test")].tolist()} == {"MPH16"}


def test_the_kinects_skeletons_are_used_aloud(built, capsys):
    module(built.root, built.cache_dir).build()
    said = capsys.readouterr().out
    assert "KINECT SKELETONS USED" in said and "--data.init_args.smplx_models" in said
    assert "2 train, 2 val, 2 test windows; 0 dropped" in said


def test_a_second_build_reads_the_first(built, monkeypatch):
    monkeypatch.setattr("sag.data.recordings.module.convert", lambda *_: pytest.fail("converted again"))
    assert module(built.root, built.cache_dir).build().fingerprint == built.cache.fingerprint


def test_a_changed_file_or_parameter_makes_another_cache(root, tmp_path):
    cache = tmp_path / "cache"
    first = module(root, cache).build().folder
    assert module(root, cache, depth="sensor").build().folder != first
    os.utime(next((root / "recordings" / TRAINED / "Skeleton").iterdir()), ns=(1, 1))
    assert module(root, cache).build().folder != first
    assert not list(cache.glob("*converting*"))


def test_frames_at_another_rate_are_named(tmp_path):
    root = write_root(tmp_path / "root", ("MPH16",))
    slow = Take(FRAMES)
    slow.seconds = 0.029 + np.arange(FRAMES) / 15
    slow.write(root, TESTED)
    notes = module(root, tmp_path).build().index["notes"]
    assert any(f"{TESTED} 15.0" in note for note in notes)


def test_broken_recordings_are_left_out_when_asked(root, tmp_path):
    shutil.copytree(root / "recordings" / TRAINED, root / "recordings" / "N0Sofa_00034_02")
    bad = min((root / "recordings" / "N0Sofa_00034_02" / "Skeleton").iterdir())
    bad.write_text("{")
    with pytest.raises(SagError, match=bad.name):
        module(root, tmp_path).build()
    index = module(root, tmp_path, skip_broken=True).build().index
    assert index["dropped"] == {why.BROKEN: 1}
    assert any("N0Sofa_00034_02 LEFT OUT" in note and bad.name in note for note in index["notes"])


# --- it refuses ---


def test_broken_recordings_of_any_kind_are_left_out(root, tmp_path):
    shutil.copytree(root / "recordings" / TRAINED, root / "recordings" / "Sofa")
    shutil.copytree(root / "recordings" / TRAINED, root / "recordings" / "Werkraum_00034_01")
    index = module(root, tmp_path, skip_broken=True).build().index
    assert index["dropped"] == {why.BROKEN: 2}
    assert len(index["sequences"]) == 2


@pytest.mark.parametrize("inside", [None, "elsewhere", "recordings/MPH16_00157_01"])
def test_a_wrong_root_is_refused_with_the_way_out(tmp_path, inside):
    if inside:
        (tmp_path / "root" / inside).mkdir(parents=True)
    with pytest.raises(SagError, match=r"root is no PROX folder: .*recordings.*prox\.is\.tue.*--data\.init_args\.root"):
        module(tmp_path / "root", tmp_path).build()


@pytest.mark.parametrize("options", [{"stride": 0}, {"cloud_step": 0}, {"limits": Limits(farthest_depth=66.0)}])
def test_wrong_parameters_are_refused(tmp_path, options):
    with pytest.raises(SagError, match=next(iter(options))):
        module(tmp_path, tmp_path, **options)


def test_a_skeleton_of_other_joints_is_refused(tmp_path):
    with pytest.raises(SagError, match=r"gta_im_19 has joints that PROX lacks: spine0, .*use prox_16"):
        module(tmp_path, tmp_path, skeleton="gta_im_19")


def test_a_link_out_of_the_root_is_refused(root, tmp_path):
    (root / "recordings" / TESTED).rename(tmp_path / "outside")
    (root / "recordings" / TESTED).symlink_to(tmp_path / "outside")
    with pytest.raises(SagError, match=f"{TESTED} leads out of"):
        module(root, tmp_path).build()


@pytest.mark.parametrize("name", ["scenes", "recordings/N0Sofa_00034_01/Skeleton"])
def test_links_of_folders_that_lead_out_are_refused(root, tmp_path, name):
    (root / name).rename(tmp_path / "outside")
    (root / name).symlink_to(tmp_path / "outside")
    with pytest.raises(SagError, match=f"{name} leads out of"):
        module(root, tmp_path).build()


def test_a_missing_scan_names_the_way_out(root, tmp_path):
    (root / "scenes" / "MPH16.ply").unlink()
    with pytest.raises(SagError, match=r"scenes/MPH16\.ply is missing: .*--data\.init_args\.depth sensor"):
        module(root, tmp_path).build()
    assert len(module(root, tmp_path, depth="sensor").build()) == 6


def test_recordings_of_other_names_are_refused(root, tmp_path):
    (root / "recordings" / TESTED).rename(root / "recordings" / "MPH16")
    with pytest.raises(SagError, match="recordings/MPH16 is not named Scene_Subject_Take"):
        module(root, tmp_path).build()


def test_no_usable_window_is_refused_with_the_reasons(root, tmp_path):
    for folder in (root / "recordings").iterdir():
        shutil.rmtree(folder / "Skeleton")
    with pytest.raises(SagError, match=r"no usable window.*no fit or skeleton in one of the frames': 12"):
        module(root, tmp_path).build()
