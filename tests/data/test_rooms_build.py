"""The cache of a tiny recipe: its bytes, its promises and its ground truth."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from toy_data import ToyDataModule

from sag.components import Components, Network, build_critics
from sag.data.base import Windows
from sag.data.cache import DEPTH_UNIT, PERSON, WindowCache
from sag.data.rooms import Recipe, RoomsDataModule, load_contact, load_geometry
from sag.data.rooms.preview import sheet
from sag.errors import SagError
from sag.metrics.collisions.counts import collision_counts
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

SIZES = {"train_rooms": 1, "test_rooms": 1, "val_rooms": 0, "views": 1, "recordings": 1, "image_size": (18, 32)}


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory) -> RoomsDataModule:
    data = RoomsDataModule(**SIZES, workers=1, cache_dir=tmp_path_factory.mktemp("rooms"), eval_batch_size=4)
    data.prepare_data()
    data.setup()
    return data


@pytest.fixture(scope="module")
def cache(module: RoomsDataModule) -> WindowCache:
    return module.cache


def world(cache: WindowCache) -> np.ndarray:
    """(n, 65, 19, 3) joints in the world frame, metres."""
    offset = np.asarray(cache.joints) - cache.world2cam[:, None, None, :3, 3]
    return np.einsum("ntjk,nkl->ntjl", offset, cache.world2cam[:, :3, :3])


def test_a_damaged_cache_is_made_again_byte_by_byte_by_any_number_of_workers(
    cache: WindowCache, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(cache.folder, tmp_path / cache.folder.name)
    (tmp_path / cache.folder.name / "geometry" / "0.json").write_text("{}")
    again = RoomsDataModule(**SIZES, workers=2, cache_dir=tmp_path).build()
    assert "rebuilding" in capsys.readouterr().out
    assert again.fingerprint == cache.fingerprint
    assert [path.name for path in tmp_path.iterdir()] == [cache.folder.name]


def test_another_seed_has_another_name(tmp_path: Path) -> None:
    one, other = (RoomsDataModule(**SIZES, seed=seed, cache_dir=tmp_path).recipe.as_dict() for seed in (0, 1))
    assert one != other
    assert Recipe.from_dict(one) == Recipe(**SIZES)


def test_every_split_has_windows_and_batches_have_the_shapes_of_the_picture(module: RoomsDataModule) -> None:
    batch = next(iter(module.test_dataloader()))
    assert batch.motion.pose.shape == (4, 65, 19, 3)
    assert batch.scene.image.shape == (4, 3, 18, 32)
    assert batch.cloud is not None and batch.cloud.depth.shape == (4, 288, 512)
    assert min(module.describe()["windows"].values()) > 0


def test_test_windows_are_from_training_rooms_and_rooms_of_their_own(cache: WindowCache) -> None:
    tested = cache.rows("test")
    assert set(np.unique(cache.scene[tested])) == {0, 1}
    assert set(np.unique(cache.scene[cache.rows("train")])) == {0}
    cameras = {tuple(m.ravel()) for m in cache.world2cam[cache.rows("train")]}
    assert not cameras & {tuple(m.ravel()) for m in cache.world2cam[tested]}
    assert not set(cache.sequence[cache.rows("train")]) & set(cache.sequence[tested])


def test_the_start_root_is_at_the_centre_of_picture_and_cloud(cache: WindowCache) -> None:
    root = cache.joints[:, 0, GTA_IM_19.root_index].astype(float)
    for matrices, rows, size in (
        (cache.intrinsics, slice(None), cache.image.shape[1:3]),
        (cache.cloud_intrinsics, cache.rows("test"), cache.cloud_depth.shape[1:]),
    ):
        pixels = np.einsum("nij,nj->ni", matrices, root[rows])
        np.testing.assert_allclose(
            pixels[:, :2] / pixels[:, 2:], np.tile([size[1] / 2, size[0] / 2], (len(pixels), 1)), atol=1e-3
        )


def test_the_root_stays_in_the_picture_and_in_front(cache: WindowCache) -> None:
    root = cache.joints[:, :, GTA_IM_19.root_index]
    pixels = np.einsum("nij,ntj->nti", cache.intrinsics, root)
    share = pixels[..., :2] / pixels[..., 2:] / np.array(cache.image.shape[2:0:-1])
    assert root[..., 2].min() > 0
    assert share.min() > 0 and share.max() < 1


def test_the_person_is_in_the_picture_and_not_in_the_cloud(cache: WindowCache) -> None:
    person = cache.ids == PERSON
    assert person.any(axis=(1, 2)).all()
    middle = cache.cloud_depth[:, 144, 256]
    assert (middle == 0).mean() > 0.9
    root = cache.joints[:, 0, GTA_IM_19.root_index, 2]
    near = np.array([abs(np.median(d[p]) * DEPTH_UNIT - z) for d, p, z in zip(cache.depth, person, root)])
    assert np.median(near) < 0.3


def test_bones_keep_their_lengths_and_people_differ(cache: WindowCache) -> None:
    parents, children = GTA_IM_19.bone_index.T
    lengths = np.linalg.norm(cache.joints[:, :, children] - cache.joints[:, :, parents], axis=-1)
    assert np.ptp(lengths, axis=1).max() < 1e-3
    assert len(np.unique(lengths[:, 0].sum(axis=-1).round(3))) == len(np.unique(cache.sequence))


def test_ankles_stay_above_the_known_floor_and_bodies_out_of_the_furniture(cache: WindowCache) -> None:
    contact, joints = load_contact(cache), world(cache)
    ankles = joints[:, :, GTA_IM_19.index("right_ankle", "left_ankle")]
    for room in np.unique(cache.scene):
        geometry, here = load_geometry(cache, int(room)), cache.scene == room
        height = ankles[here][..., 2] - geometry.floor_height(ankles[here][..., :2])
        assert height.min() > 0.03
        assert np.median(height.min(axis=-1)) == pytest.approx(0.085, abs=0.02)
        free = joints[here][~contact[here]]
        assert (geometry.signed_distance(free) < 0).mean() < 1e-3


def test_true_motions_do_not_collide_but_those_of_other_scenes_do(cache: WindowCache) -> None:
    """Frames at a seat count apart: the seat is to be touched."""
    contact, rows = load_contact(cache), cache.rows("test")
    bones, own, other = torch.tensor(GTA_IM_19.bone_index), [], []
    for row in rows[::2]:
        frames = np.flatnonzero(~contact[row])[::6]
        strangers = rows[cache.scene[rows] != cache.scene[row]]
        for place, counts in ((row, own), (strangers[row % len(strangers)], other)):
            cloud = torch.tensor(cache.cloud_depth[cache.cloud_row[place]] * np.float32(DEPTH_UNIT))
            camera = torch.tensor(cache.cloud_intrinsics[cache.cloud_row[place]])
            counts += collision_counts(torch.tensor(cache.joints[row][frames]), bones, cloud, camera, (0.06,))[
                :, 0
            ].tolist()
    assert np.mean(np.array(own) < 40) >= 0.99
    assert np.mean(np.array(other) >= 40) > 0.03


def test_dropped_windows_are_counted_by_reason(cache: WindowCache) -> None:
    assert all(isinstance(count, int) and count > 0 for count in cache.index["dropped"].values())
    assert cache.index["fps"] == 30


def test_a_sheet_shows_windows(cache: WindowCache, tmp_path: Path) -> None:
    sheet(cache, tmp_path / "sheets" / "rooms.png", count=3)
    assert (tmp_path / "sheets" / "rooms.png").stat().st_size > 50_000


@pytest.mark.parametrize("wrong", [{"train_rooms": 0}, {"image_size": (64, 64)}, {"skeleton": "prox_16"}])
def test_impossible_sizes_are_refused_with_the_name_of_their_field(wrong: dict[str, object], tmp_path: Path) -> None:
    with pytest.raises(SagError, match=f"data.init_args.{next(iter(wrong))}"):
        RoomsDataModule(**{**SIZES, **wrong}, cache_dir=tmp_path)


def test_other_data_sets_have_no_known_geometry(tmp_path: Path) -> None:
    toy = ToyDataModule(cache_dir=tmp_path).build()
    for ask in (lambda: load_geometry(toy, 0), lambda: load_contact(toy), lambda: sheet(toy, tmp_path / "no.png")):
        with pytest.raises(SagError):
            ask()


@pytest.mark.parametrize("name", ["trajectory", "pose", "projection"])
def test_critics_see_the_people_of_rooms_to_one_scale(name: str, module: RoomsDataModule) -> None:
    scale = MotionScale(19, GTA_IM_19.root_index)
    scale.fit(module.training_motion)
    windows = Windows(module.cache, "train", GTA_IM_19)
    batch = windows.__getitems__(list(range(len(windows))))
    critic = build_critics(Components(), Network(width=0.1, critic_norm="layer"), GTA_IM_19, scale)[name]
    view = critic.view(batch.motion, DepthMap(batch.scene.depth, batch.scene.intrinsics))
    assert 0.6 < view.std() < 1.7
