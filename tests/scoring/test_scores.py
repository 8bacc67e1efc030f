"""The score sheet: what is on it for which data, what it says of itself, and that batches make no difference."""

from pathlib import Path

import numpy as np
import pytest
import torch
from toy_data import ToyDataModule

from sag.data.cache import WindowCache
from sag.errors import SagError
from sag.models.erd import MotionEncoders
from sag.scoring import Evaluation, Floors, Groups, Scores
from sag.scoring.judged import Judged
from sag.types import Batch


@pytest.fixture(scope="module")
def encoders() -> MotionEncoders:
    torch.manual_seed(0)
    return MotionEncoders("gta_im_19", width=0.01).double().eval()


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> ToyDataModule:
    """Eight test windows of four recordings."""
    module = ToyDataModule(tmp_path_factory.mktemp("many"), windows=16)
    module.build()
    return module


def made(batch: Batch, k: int = 3) -> torch.Tensor:
    """Motions that are not the true ones."""
    noise = 0.03 * torch.randn(len(batch), k, 65, 19, 3, generator=torch.manual_seed(1))
    noise[:, :, 0] = 0
    return batch.motion.joints[:, None] + noise.cumsum(2)


def scored(data: ToyDataModule, encoders: MotionEncoders | None, size: int, **protocol) -> dict[str, float]:
    sheet = Scores(data, "test", encoders, Evaluation(**protocol))
    whole = next(iter(ToyDataModule(data.cache_dir, windows=16, eval_batch_size=8).test_dataloader()))
    samples = made(whole)
    for part in torch.arange(8).split(size):
        sheet.update(whole[part], samples[part])
    return {name: float(figure) for name, figure in sheet.compute().items()}


EXPECTED = {
    "motion_fid/average", "motion_kid/average", "motion_fid_infinity/average", "motion_fid_interval/low",
    "non_collision/average", "velocity_frechet", "scene_frechet", "collisions/ratio", "floor/error", "foot_skate",
    "foot_contact", "bone_drift", "acceleration", "jerk", "diversity/deviation", "diversity/pairwise",
    "diversity/multimodality", "best_of/path_2", "best_of/pose_0.5",
}  # fmt: skip


def test_everything_is_on_the_sheet_once_and_known_geometry_only_where_it_is_known(many, encoders):
    found = scored(many, encoders, 8)
    assert set(found) >= EXPECTED
    assert not {name for name in found if name.startswith(("penetration", "depth_error"))}
    unknown = {"collisions/ratio"}  # nothing may collide elsewhere
    assert all(torch.tensor(found[name]).isfinite() for name in EXPECTED - unknown)


def test_batches_make_no_difference(many, encoders):
    one, two = scored(many, encoders, 8), scored(many, encoders, 3)
    assert two == pytest.approx(one, rel=1e-9, abs=1e-9, nan_ok=True)


def test_without_encoders_or_resamples_there_is_less(many, encoders):
    without = set(scored(many, None, 8))
    assert "velocity_frechet" in without
    assert not {name for name in without if name.startswith("motion_") or name.endswith("multimodality")}
    assert not {name for name in scored(many, encoders, 8, resamples=0) if "interval" in name or "infinity" in name}


def test_the_protocol_says_what_the_figures_rest_on(many, encoders):
    sheet = Scores(many, "test", encoders, Evaluation(collision_frames=16, samples=3))
    for batch in many.test_dataloader():
        sheet.update(batch, made(batch))
    found = sheet.protocol()
    assert (found["motions"], found["groups"], found["samples"], found["collision_frames"]) == (
        8,
        "4 recordings",
        3,
        16,
    )
    assert (found["collision_shape"], found["floor"]) == ("capsule", "estimated from depth")
    distances = sheet.distances()
    assert len(distances) == 18 and {d["real"] for d in distances if d["frames"] == 2} == {8 * 32}


def test_true_motions_have_no_distance_and_their_floor_is_above_it(many, encoders):
    groups = Groups.of(many.cache, many.cache.rows("test"))
    sheet, floors = Scores(many, "test", encoders, Evaluation(), drawn=False), Floors(many, groups, 0, "cpu")
    for batch in many.test_dataloader():
        floors.update(sheet.update(batch, batch.motion.joints[:, None]))
    truth, floor = sheet.compute(), floors.compute()
    for name in ("motion_fid/average", "velocity_frechet", "scene_frechet"):
        head, _, tail = name.partition("/")
        assert float(truth[name]) == pytest.approx(0, abs=1e-6)
        assert float(floor["/".join(filter(None, (f"{head}_floor", tail)))]) > 1e-4
    assert not {name for name in truth if name.startswith(("best_of", "diversity"))}, "nothing is drawn"


def test_rooms_are_the_groups_where_there_are_enough():
    def groups(rooms: int) -> Groups:
        cache = WindowCache(Path(), {})
        object.__setattr__(cache, "scene", np.arange(24) % rooms)
        object.__setattr__(cache, "sequence", np.arange(24) // 2)
        return Groups.of(cache, np.arange(24))

    assert (groups(8).kind, groups(8).count) == ("rooms", 8)
    assert (groups(7).kind, groups(7).count) == ("recordings", 12)


def test_depth_is_scored_where_a_method_has_an_opinion(many):
    sheet = Scores(many, "test", None, Evaluation())
    for batch in many.test_dataloader():
        sheet.update(batch, made(batch), 1.1 * batch.scene.depth + 0.5 * (batch.scene.depth == 0))
    assert float(sheet.compute()["depth_error/abs_rel"]) == pytest.approx(0.1, abs=1e-5)


def test_depth_is_read_off_features_where_both_halves_of_the_rooms_are_seen(many):
    sheet = Scores(many, "test", None, Evaluation())
    batches = list(many.test_dataloader())
    one = batches[0][batches[0].room == batches[0].room[0]]
    sheet.update(one, made(one), feature=one.scene.depth.mean((1, 2))[:, None])
    assert not any(name.startswith("depth_probe") for name in sheet.compute())
    for batch in batches:
        sheet.update(batch, made(batch), feature=batch.scene.depth.mean((1, 2))[:, None])
    assert {"depth_probe/rmse", "depth_probe/explained"} <= set(sheet.compute())


def test_moved_motions_start_where_the_other_person_stands(many):
    batch = next(iter(many.test_dataloader()))
    judged = Judged(batch, batch.motion.joints[:, None], many, None)
    other = judged.elsewhere
    assert other is not None and (other.room != batch.room).all()
    assert torch.allclose(judged.moved_to(other)[:, 0, 12, ::2], other.motion.roots[:, 0, ::2], atol=1e-4)
    again = Judged(batch, batch.motion.joints[:, None], many, None).elsewhere
    assert again is not None and torch.equal(again.index, other.index)


@pytest.mark.parametrize(("name", "value"), [("samples", 0), ("collision_frames", 0), ("resamples", -1)])
def test_impossible_protocols_are_refused(name, value):
    with pytest.raises(SagError, match=f"evaluation.{name} must be at least"):
        Evaluation(**{name: value})


def test_windows_without_depth_are_named(many):
    batch = next(iter(many.val_dataloader()))
    with pytest.raises(SagError, match="toy has no depth"):
        Scores(many, "test", None, Evaluation(samples=1)).update(batch, batch.motion.joints[:, None])


class Hall:
    """An empty hall whose floor lies at height 0."""

    def signed_distance(self, points: np.ndarray) -> np.ndarray:
        return np.full(points.shape[:-1], 9.0)

    def floor_height(self, points: np.ndarray) -> np.ndarray:
        return np.zeros(points.shape[:-1])


def test_validation_measures_what_needs_no_cloud(many, encoders, monkeypatch):
    names = set(Scores(many, "val", encoders, Evaluation()).sheet())
    assert "motion_fid" in names and not names & {"floor", "penetration", "collisions", "non_collision"}
    monkeypatch.setattr(many, "geometry", lambda room: Hall())
    sheet = Scores(many, "val", encoders, Evaluation())
    assert set(sheet.sheet()) == names | {"floor", "foot_skate", "foot_contact", "penetration"}
    for batch in many.val_dataloader():
        sheet.update(batch, made(batch))
    assert sheet.compute()["penetration/share"] == 0
