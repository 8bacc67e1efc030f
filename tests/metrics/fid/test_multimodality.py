"""Multimodality: pairwise distance in the encoder's features of whole motions."""

import pickle

import numpy as np
import pytest
import torch
from torch import Tensor
from toy_data import walks

from sag.errors import SagError
from sag.metrics.fid.multimodality import Multimodality, whole_motion_features
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index


@pytest.fixture(scope="module")
def encoders() -> MotionEncoders:
    torch.manual_seed(0)
    return MotionEncoders("gta_im_19", width=0.01).eval()


@pytest.fixture(scope="module")
def samples() -> Tensor:
    return torch.from_numpy(walks(20, np.random.default_rng(1))).unflatten(0, (4, 5))


def figure(encoders: MotionEncoders, samples: Tensor) -> float:
    metric = Multimodality(encoders, ROOT)
    metric.update(samples)
    return float(metric.compute())


def test_the_feature_is_the_64_frame_encoders_last_state(encoders, samples):
    motions = samples.flatten(0, 1)
    clips = motions[:, 1:] - motions[:, 1:2, ROOT : ROOT + 1]
    (expected,) = encoders.of(64).features(clips, [64])
    torch.testing.assert_close(whole_motion_features(encoders, motions, ROOT), expected.detach())


def test_equals_its_definition(encoders, samples):
    features = [whole_motion_features(encoders, window, ROOT).double() for window in samples]
    pairs = [(f[i] - f[j]).norm() for f in features for i in range(5) for j in range(i)]
    assert figure(encoders, samples) == pytest.approx(float(torch.stack(pairs).mean()), rel=1e-5)


def test_known_features_save_the_pass(encoders, samples):
    metric = Multimodality(encoders, ROOT)
    metric.update_features(whole_motion_features(encoders, samples.flatten(0, 1), ROOT).unflatten(0, (4, 5)))
    assert float(metric.compute()) == pytest.approx(figure(encoders, samples), rel=1e-6)
    metric.update_features(torch.zeros(4, 5, encoders.dimension))
    assert float(metric.compute()) == pytest.approx(figure(encoders, samples) / 2, rel=1e-6)


def test_one_motion_drawn_again_is_none_and_other_ways_are_more(encoders, samples):
    same = samples[:, :1].expand_as(samples)
    moved = same + torch.linspace(0, 1, 5)[None, :, None, None, None]
    assert figure(encoders, same) < 1e-5
    assert figure(encoders, moved) < 1e-4, "where a motion happens makes no difference"
    assert figure(encoders, samples) > 0.01


def test_what_the_encoder_was_given_beforehand_makes_no_difference(encoders, samples):
    changed = samples.clone()
    changed[:, :, 0] = 0
    assert figure(encoders, changed) == figure(encoders, samples)


def test_half_precision_is_read_in_full(encoders, samples):
    assert figure(encoders, samples.bfloat16()) == pytest.approx(figure(encoders, samples), rel=0.2)


def test_a_checkpoint_does_not_carry_the_encoders_and_a_pickle_does(encoders, samples):
    metric = Multimodality(encoders, ROOT)
    metric.update(samples)
    assert not metric.state_dict() and not list(metric.parameters())
    assert pickle.loads(pickle.dumps(metric)).compute() == metric.compute()


def test_refuses(encoders, samples):
    metric = Multimodality(encoders, ROOT)
    with pytest.raises(SagError, match="before any window"):
        metric.compute()
    with pytest.raises(SagError, match="19 joints, not 65 frames of 16 joints"):
        metric.update(samples[:, :, :, :16])
    with pytest.raises(SagError, match="at least 2 samples"):
        metric.update(samples[:, :1])
    with pytest.raises(SagError, match="not finite"):
        metric.update(samples / 0)
    with pytest.raises(SagError, match="features that are not finite"):
        metric.update_features(torch.full((2, 3, 4), torch.nan))
