"""Motion FID: its clips, its sums, what it reacts to and what it refuses."""

import copy
import pickle

import numpy as np
import pytest
import torch
from torch import Tensor
from toy_data import walks

from sag.errors import SagError
from sag.metrics import MotionFID, frechet_distance, motion_fid_floor
from sag.metrics.clips import GROUPS, LENGTHS, clips_by_longest
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


@pytest.fixture(scope="module")
def encoders() -> MotionEncoders:
    """Untrained, which is enough for everything but the meaning of the figures; float64, so that sums are exact."""
    torch.manual_seed(0)
    return MotionEncoders("gta_im_19", width=0.01).double().eval()


@pytest.fixture(scope="module")
def motions() -> Tensor:
    return torch.from_numpy(walks(48, np.random.default_rng(1))).double()


@pytest.fixture(scope="module")
def others() -> Tensor:
    return torch.from_numpy(walks(48, np.random.default_rng(2))).double()


def motion_fid(encoders: MotionEncoders, real: Tensor, generated: Tensor, size: int = 48) -> dict[str, float]:
    metric = MotionFID(encoders, ROOT)
    for side, is_real in ((real, True), (generated, False)):
        for chunk in side.split(size):
            metric.update(chunk, real=is_real)
    return {name: float(value) for name, value in metric.compute().items()}


def clip_by_clip(encoders: MotionEncoders, motions: Tensor, length: int) -> dict[tuple[int, int], Tensor]:
    """Features of the disjoint clips of one length, the plain way, (b, clips, d)."""
    clips = motions[:, 1:].unflatten(1, (64 // length, length)).flatten(0, 1)
    found = encoders.features(clips - clips[:, :1, ROOT : ROOT + 1], [length])
    return {key: features.unflatten(0, (len(motions), -1)) for key, features in found.items()}


def test_each_start_is_run_once_and_every_clip_of_every_length_is_in_it(motions):
    found = clips_by_longest(motions[:, 1:], ROOT)
    assert {length: len(clips) // len(motions) for length, clips in found.items()} == {
        2: 16, 4: 8, 8: 4, 16: 2, 32: 1, 64: 1,
    }  # fmt: skip
    for length in LENGTHS:
        assert sum(len(found[longer]) for longer in LENGTHS if longer >= length) == len(motions) * 64 // length


def test_prefix_features_are_the_bits_of_clip_by_clip(encoders, motions):
    single = copy.deepcopy(encoders).float()
    motions = motions.float()
    for longest, clips in clips_by_longest(motions[:, 1:], ROOT).items():
        starts = [0] if longest == 64 else list(range(longest, 64, 2 * longest))
        lengths = [length for length in LENGTHS if length <= longest]
        for (frames, length), found in single.features(clips, lengths).items():
            plain = clip_by_clip(single, motions, length)[frames, length][:, [s // length for s in starts]]
            assert torch.equal(found, plain.flatten(0, 1)), (frames, length)


def test_equals_its_definition(encoders, motions, others):
    distances = {}
    for length in LENGTHS:
        real, generated = (clip_by_clip(encoders, x, length) for x in (motions, others))
        for key in real:
            a, b = (x[key].flatten(0, 1).detach() for x in (real, generated))
            distances[key] = float(frechet_distance(a.mean(0), a.T.cov(), b.mean(0), b.T.cov()))
    expected = {
        name: np.mean([d for (_, length), d in distances.items() if length in group]) for name, group in GROUPS.items()
    }
    expected["average"] = np.mean(list(expected.values()))
    assert len(distances) == 18
    assert motion_fid(encoders, motions, others) == pytest.approx(expected, rel=1e-6)


def test_identical_sets_are_at_zero_and_others_are_not(encoders, motions, others):
    floor = max(motion_fid(encoders, motions, motions).values())
    assert 0 <= floor < 1e-9
    assert min(motion_fid(encoders, motions, others).values()) > 1e3 * floor


def test_batches_and_order_make_no_difference(encoders, motions, others):
    whole = motion_fid(encoders, motions, others)
    assert motion_fid(encoders, motions, others, size=7) == pytest.approx(whole, abs=1e-12)
    assert motion_fid(encoders, motions.flip(0), others[torch.randperm(48)]) == pytest.approx(whole, abs=1e-12)


def test_where_a_motion_happens_makes_no_difference_and_how_does(encoders, motions, others):
    whole = motion_fid(encoders, motions, others)
    elsewhere = others + torch.tensor([3.0, 0, -1])
    assert motion_fid(encoders, motions, elsewhere) == pytest.approx(whole, rel=1e-6)
    still = others[:, :1].expand_as(others)
    assert motion_fid(encoders, motions, still)["long"] > 2 * whole["long"]


def test_the_given_frame_is_left_out(encoders, motions, others):
    changed = others.clone()
    changed[:, 0] = 0
    assert motion_fid(encoders, motions, changed) == motion_fid(encoders, motions, others)


def test_distances_say_dimension_and_sizes(encoders, motions, others):
    metric = MotionFID(encoders, ROOT)
    metric.update(motions, real=True)
    metric.update(others[:30], real=False)
    found = metric.distances()
    assert set(found) == {(frames, length) for frames in (16, 32, 64) for length in LENGTHS}
    assert found[16, 8][1:] == (encoders.dimension, 48 * 8, 30 * 8)
    short = [distance.distance for (_, length), distance in found.items() if length in GROUPS["short"]]
    assert float(metric.compute()["short"]) == pytest.approx(np.mean(short))


def test_reset_forgets_both_sides_or_only_the_generated_one(encoders, motions, others):
    expected = motion_fid(encoders, motions, others)
    for kept in (False, True):
        metric = MotionFID(encoders, ROOT, reset_real=not kept)
        metric.update(motions, real=True)
        metric.update(motions, real=False)
        metric.compute()
        metric.reset()
        assert metric.has_real == kept
        if not kept:
            metric.update(motions, real=True)
        metric.update(others, real=False)
        assert {k: float(v) for k, v in metric.compute().items()} == pytest.approx(expected, abs=1e-12)


def test_clones_and_pickles_carry_their_state(encoders, motions, others):
    metric = MotionFID(encoders, ROOT)
    metric.update(motions, real=True)
    metric.update(others, real=False)
    expected = metric.compute()
    for copied in (metric.clone(), pickle.loads(pickle.dumps(metric))):
        assert copied.compute() == expected
    clone = metric.clone()
    clone.update(motions, real=False)
    assert metric.compute() == expected and clone.compute() != expected


def test_a_checkpoint_does_not_carry_the_encoders(encoders):
    holder = torch.nn.ModuleDict({"metric": MotionFID(encoders, ROOT)})
    assert not holder.state_dict() and not list(holder.parameters())


def test_the_floor_splits_by_sequence(encoders, motions):
    sequence = torch.tensor([5, 9, 2, 7]).repeat_interleave(12)
    floor = motion_fid_floor(encoders, motions, sequence, ROOT)
    halves = motions[24:36], motions[12:24]  # 2 and 7 against 5 and 9: every other one in order
    first = torch.cat([halves[0], motions[36:]])
    second = torch.cat([motions[:12], halves[1]])
    assert {k: float(v) for k, v in floor.items()} == pytest.approx(motion_fid(encoders, first, second), rel=1e-9)


def test_refuses(encoders, motions):
    metric = MotionFID(encoders, ROOT)
    with pytest.raises(SagError, match="65 frames of 19 joints, as its encoders do, not 65 frames of 16 joints"):
        metric.update(motions[:, :, :16], real=True)
    with pytest.raises(SagError, match="not 64 frames"):
        metric.update(motions[:, 1:], real=True)
    broken = motions.clone()
    broken[3, 5] = torch.nan
    with pytest.raises(SagError, match="not finite"):
        metric.update(broken, real=False)
    metric.update(motions, real=True)
    metric.update(motions[:0], real=False)
    with pytest.raises(SagError, match="at least 2 generated motions, it was given 0"):
        metric.compute()
    with pytest.raises(SagError, match="at least 2 sequences"):
        motion_fid_floor(encoders, motions, torch.zeros(48, dtype=torch.long), ROOT)


def test_the_real_side_can_be_shared(encoders, motions, others):
    first, second = MotionFID(encoders, ROOT), MotionFID(encoders, ROOT)
    first.update(motions, real=True)
    second.update(others, real=False)
    second.share_real(first)
    assert {k: float(v) for k, v in second.compute().items()} == motion_fid(encoders, motions, others)
