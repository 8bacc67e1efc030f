import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from gta_im_files import COLUMNS, ROWS, SIZE, Sequence, module

from sag.data.gta_im import GtaImDataModule
from sag.data.gta_im.recording import Recording
from sag.data.recordings import filters as why
from sag.data.recordings.filters import Limits
from sag.errors import SagError
from sag.types import FRAMES


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> GtaImDataModule:
    """One recording with six windows."""
    folder = tmp_path_factory.mktemp("gta")
    Sequence().write(folder / "FPS-30" / "a")
    data = module(folder, folder / "cache")
    data.setup()
    return data


# --- it runs ---


def test_batches_have_their_shapes(built):
    batch = next(iter(built.test_dataloader()))
    assert batch.motion.joints.shape == (6, FRAMES, 19, 3)
    assert batch.scene.image.shape == (6, 3, *SIZE)
    assert batch.scene.depth.shape == batch.scene.person.shape == (6, *SIZE)
    assert batch.cloud.depth.shape == (6, ROWS, COLUMNS)
    assert next(iter(built.val_dataloader())).cloud is None
    assert built.fps == 30 and built.training_motion.joints.shape == (6, FRAMES, 19, 3)


def test_one_recording_trains_and_tests_on_the_same_windows_aloud(built, capsys):
    data = module(built.root, built.cache_dir)
    data.build()
    said = capsys.readouterr().out
    notes = data.cache.index["notes"]
    assert all(note in said for note in notes)
    assert any("TRAINING AND TEST WINDOWS ARE THE SAME" in note for note in notes)
    assert any("stride 1 instead of 5" in note for note in notes)
    assert "6 train, 6 val, 6 test windows; " in said
    starts = [data.cache.start[data.cache.rows(split)].tolist() for split in ("train", "val", "test")]
    assert starts == [list(range(6))] * 3


def test_a_second_build_reads_the_first(built, monkeypatch):
    monkeypatch.setattr("sag.data.recordings.module.convert", lambda *_: pytest.fail("converted again"))
    assert module(built.root, built.cache_dir).build().fingerprint == built.cache.fingerprint


def test_a_changed_file_or_parameter_makes_another_cache(tmp_path):
    folder = Sequence().write(tmp_path / "FPS-30" / "a", pictured=[0])
    first = module(tmp_path, tmp_path).build().folder
    assert module(tmp_path, tmp_path, limits=Limits(root_step=0.2)).build().folder != first
    os.utime(folder / "00000.jpg", ns=(1, 1))
    assert module(tmp_path, tmp_path).build().folder != first
    assert not list(tmp_path.glob("*converting*")) and not list(tmp_path.glob("*partial*"))


def test_rooms_split_a_whole_data_set(tmp_path):
    for name, room in (("a", 1), ("b", 2), ("c", 3), ("d", 13), ("e", 77)):
        Sequence().write(tmp_path / "FPS-30" / name, room, pictured=[0, 5])
    data = module(tmp_path, tmp_path, stride=5)
    data.setup()
    cache = data.cache
    scenes = {split: set(cache.scene[cache.rows(split)].tolist()) for split in ("train", "val", "test")}
    assert scenes == {"train": {1, 3}, "val": {2}, "test": {13}}
    assert cache.index["dropped"] == {why.OTHER_ROOM: 2}
    assert cache.start[cache.rows("test")].tolist() == [0, 5]
    assert (cache.cloud_row[cache.rows("test")] >= 0).all() and (cache.cloud_row[cache.rows("train")] == -1).all()
    assert not any(word in note for note in cache.index["notes"] for word in ("SAME", "SPLIT", "VALIDATION"))


def test_the_other_rate_is_used_aloud(tmp_path):
    Sequence().write(tmp_path / "FPS-5" / "a", pictured=[0])
    data = module(tmp_path, tmp_path)
    data.setup()
    assert data.fps == 5
    assert any("FPS-5 USED" in note for note in data.cache.index["notes"])


# --- it refuses ---


@pytest.mark.parametrize("inside", [None, "elsewhere", "FPS-30/empty"])
def test_a_wrong_root_is_refused_with_the_way_out(tmp_path, inside):
    if inside:
        (tmp_path / "root" / inside).mkdir(parents=True)
    with pytest.raises(SagError, match=r"root is no GTA-IM folder: .*FPS-30.*on request.*--data\.init_args\.root"):
        module(tmp_path / "root", tmp_path).build()


def test_no_usable_window_is_refused_with_the_reasons(tmp_path):
    Sequence().write(tmp_path / "FPS-30" / "a", pictured=[])
    with pytest.raises(SagError, match=f"no usable window.*{why.NO_PICTURE}"):
        module(tmp_path, tmp_path).build()


@pytest.mark.parametrize(
    "options", [{"stride": 0}, {"cloud_step": 0}, {"rate": "FPS-60"}, {"limits": Limits(farthest_depth=66.0)}]
)
def test_wrong_parameters_are_refused(tmp_path, options):
    with pytest.raises(SagError, match=next(iter(options))):
        module(tmp_path, tmp_path, **options)


class Gadget:
    def __init__(self, canary: Path):
        self.canary = canary

    def __reduce__(self):
        return os.mkdir, (str(self.canary),)


@pytest.mark.parametrize("name", ["info_frames.pickle", "realtimeinfo.gz"])
def test_hostile_pickles_are_refused_and_not_run(tmp_path, name):
    folder = Sequence().write(tmp_path / "FPS-30" / "a", pictured=[0])
    (folder / name).write_bytes(pickle.dumps({"setting": Gadget(tmp_path / "canary")}))
    with pytest.raises(SagError, match=rf"{name} is refused because it names \w+\.mkdir"):
        module(tmp_path, tmp_path).build()
    assert not (tmp_path / "canary").exists()


def test_hostile_arrays_are_refused_and_not_run(tmp_path):
    folder = Sequence().write(tmp_path / "a", pictured=[])
    np.savez(folder / "info_frames.npz", joints_3d_world=np.array([Gadget(tmp_path / "canary")]))
    with pytest.raises(SagError, match=r"info_frames\.npz holds joints_3d_world of .* type object"):
        Recording.read(folder)
    assert not (tmp_path / "canary").exists()


@pytest.mark.parametrize("shape", [(70, 20, 3), (69, 21, 3)])
def test_arrays_of_another_layout_are_refused(tmp_path, shape):
    folder = Sequence().write(tmp_path / "a", pictured=[])
    arrays = dict(np.load(folder / "info_frames.npz"))
    np.savez(folder / "info_frames.npz", **{**arrays, "joints_3d_world": np.zeros(shape)})
    with pytest.raises(SagError, match=r"info_frames\.npz holds"):
        Recording.read(folder)


def test_a_disk_without_room_is_refused_before_the_conversion(tmp_path, monkeypatch):
    Sequence().write(tmp_path / "FPS-30" / "a", pictured=[0])
    monkeypatch.setattr("shutil.disk_usage", lambda _: type("Usage", (), {"free": 1000})())
    with pytest.raises(SagError, match=r"GB in .*cache_dir"):
        module(tmp_path, tmp_path).build()
