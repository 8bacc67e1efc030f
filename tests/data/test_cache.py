import json
import random
from pathlib import Path

import numpy as np
import pytest
import torch
from toy_data import ToyDataModule

from sag.data.base import Windows
from sag.data.cache import ARRAYS, PERSON, WindowCache, open_or_build, recipe_hash, sha256_of, write_cache
from sag.errors import SagError
from sag.geometry.camera import project
from sag.skeleton import GTA_IM_19


@pytest.fixture
def module(tmp_path: Path) -> ToyDataModule:
    return ToyDataModule(tmp_path)


def test_recipes_that_differ_have_other_names() -> None:
    assert recipe_hash({"a": 1, "b": 2}) == recipe_hash({"b": 2, "a": 1})
    assert recipe_hash({"a": 1}) != recipe_hash({"a": 2})


def test_the_same_recipe_is_built_once_and_has_the_same_bytes(module: ToyDataModule, tmp_path: Path) -> None:
    first = module.build()
    written = (first.folder / "joints.npy").stat().st_mtime_ns
    assert module.build().fingerprint == first.fingerprint
    assert (first.folder / "joints.npy").stat().st_mtime_ns == written
    assert ToyDataModule(tmp_path / "elsewhere").build().fingerprint == first.fingerprint


@pytest.mark.parametrize("name", ["joints.npy", "image.npy", "cloud_depth.npy"])
def test_a_flipped_bit_is_noticed_named_and_mended(
    module: ToyDataModule, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    cache = module.build()
    content = bytearray((cache.folder / name).read_bytes())
    content[-3] ^= 4
    (cache.folder / name).write_bytes(content)
    with pytest.raises(SagError, match=name):
        WindowCache.open(cache.folder)
    assert module.build().fingerprint == cache.fingerprint
    assert name in capsys.readouterr().out


def test_unchanged_files_are_not_read_again_and_changed_ones_are(
    module: ToyDataModule, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache = module.build()
    read: list[str] = []

    def noting(path: Path) -> str:
        read.append(path.name)
        return sha256_of(path)

    monkeypatch.setattr("sag.data.cache.sha256_of", noting)
    WindowCache.open(cache.folder)
    assert read == []
    (cache.folder / "split.npy").touch()
    WindowCache.open(cache.folder)
    assert "split.npy" in read
    (cache.folder / "verified.json").unlink()
    read.clear()
    WindowCache.open(cache.folder)
    assert sorted(read) == sorted(cache.index["files"])


def test_a_half_written_folder_is_rebuilt(module: ToyDataModule) -> None:
    cache = module.build()
    (cache.folder / "index.json").unlink()
    with pytest.raises(SagError, match=r"index\.json"):
        WindowCache.open(cache.folder)
    assert module.build().fingerprint == cache.fingerprint


def test_a_damaged_index_is_named(module: ToyDataModule) -> None:
    cache = module.build()
    (cache.folder / "index.json").write_text('{"files": [')
    with pytest.raises(SagError, match=r"index\.json cannot be read"):
        WindowCache.open(cache.folder)


def damaged(content: bytes, chance: random.Random) -> bytes:
    """With a bit flipped, or cut short."""
    place = chance.randrange(len(content))
    if chance.random() < 0.3:
        return content[:place]
    return content[:place] + bytes([content[place] ^ 1 << chance.randrange(8)]) + content[place + 1 :]


def test_every_flipped_bit_and_every_cut_of_any_file_is_noticed_and_named(module: ToyDataModule, tally) -> None:
    cache, chance = module.build(), random.Random(0)
    for name in ("index.json", *cache.index["files"]):
        path = cache.folder / name
        whole = path.read_bytes()
        for _ in range(60 if name == "index.json" else 6):
            (cache.folder / "verified.json").unlink(missing_ok=True)  # a second of an old clock may hide a change
            path.write_bytes(damaged(whole, chance))
            with pytest.raises(SagError, match=name.replace(".", r"\.")):
                WindowCache.open(cache.folder)
            tally["flips and cuts of caches and their indices, all noticed"] += 1
        path.write_bytes(whole)
    WindowCache.open(cache.folder)


def test_a_build_that_fails_leaves_nothing(tmp_path: Path) -> None:
    def fail(folder: Path) -> WindowCache:
        return write_cache(folder, {name: np.zeros(1, dtype) for name, (dtype, _) in ARRAYS.items()}, {"bad": {1, 2}})

    with pytest.raises(TypeError):
        open_or_build(tmp_path, "toy", {}, fail)
    assert list(tmp_path.iterdir()) == []


def test_arrays_must_be_of_the_schema(tmp_path: Path) -> None:
    arrays = {name: np.zeros(1, dtype) for name, (dtype, _) in ARRAYS.items()}
    with pytest.raises(SagError, match="joints must be float32"):
        write_cache(tmp_path / "x", {**arrays, "joints": np.zeros(1)}, {})
    del arrays["split"]
    with pytest.raises(SagError, match="split"):
        write_cache(tmp_path / "x", arrays, {})


def test_windows_are_what_was_stored(module: ToyDataModule) -> None:
    cache = module.build()
    windows = Windows(cache, "test", GTA_IM_19, with_cloud=True)
    batch = windows.__getitems__([1, 0])
    rows = cache.rows("test")[[1, 0]]
    assert batch.index.tolist() == rows.tolist()
    assert np.allclose(batch.motion.joints, cache.joints[rows], atol=1e-6)
    assert np.allclose(batch.scene.depth, cache.depth[rows] / 1000)
    assert np.array_equal(batch.scene.person.numpy(), cache.ids[rows] == PERSON)
    assert 0 <= batch.scene.image.min() <= batch.scene.image.max() <= 1
    assert batch.cloud is not None
    assert batch.cloud.depth[batch.scene.person].abs().max() == 0


def test_the_start_is_at_the_centre(module: ToyDataModule) -> None:
    module.build()
    batch = next(iter(module.test_dataloader()))
    rows, columns = module.image_size
    centre = project(batch.motion.start, batch.scene.intrinsics)
    assert torch.allclose(centre, torch.tensor([columns / 2, rows / 2]).expand_as(centre), atol=1e-3)


def test_loaders_cover_each_window_once(module: ToyDataModule) -> None:
    for loader, split in ((module.test_dataloader(), "test"), (module.val_dataloader(), "val")):
        seen = [int(i) for batch in loader for i in batch.index]
        assert seen == module.cache.rows(split).tolist()
    shuffled = {int(i) for batch in module.train_dataloader() for i in batch.index}
    assert shuffled == set(module.cache.rows("train").tolist())


def test_a_description_says_what_must_agree(module: ToyDataModule) -> None:
    described = json.loads(json.dumps(module.describe()))
    assert described["windows"] == {"train": 8, "val": 4, "test": 4}
    assert described["fps"] == 30
    assert described["fingerprint"] == module.cache.fingerprint
