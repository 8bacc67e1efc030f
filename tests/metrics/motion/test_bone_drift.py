"""Bone drift: stretched bones are seen, rigid motion and bent joints are not."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import STANDING

from sag.errors import SagError
from sag.metrics.motion.bone_drift import BoneDrift, bone_drift
from sag.skeleton import GTA_IM_19

BONES = GTA_IM_19.bone_index


def standing(count: int = 3) -> Tensor:
    return torch.from_numpy(STANDING).expand(count, 65, 19, 3).clone() + torch.tensor([0.0, 0, 3])


def drift(joints: Tensor, size: int = 100) -> float:
    metric = BoneDrift(BONES)
    for part in joints.split(size):
        metric.update(part)
    return float(metric.compute())


@given(seed=st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_a_rigid_motion_makes_no_difference(seed):
    generator = torch.manual_seed(seed)
    rotations = torch.linalg.qr(torch.randn(65, 3, 3, generator=generator).double())[0]
    moved = standing() @ rotations + torch.randn(65, 1, 3, generator=generator)
    assert drift(moved) < 1e-12


@given(factor=st.floats(0.5, 2), frame=st.integers(1, 64))
@settings(max_examples=20, deadline=None)
def test_a_body_that_grows_by_a_share_drifts_by_that_share_of_the_time(factor, frame):
    joints = standing()
    joints[:, frame:] *= factor
    assert drift(joints) == pytest.approx(abs(factor - 1) * (65 - frame) / 64)


def test_a_bent_knee_makes_no_difference_and_a_stretched_shin_is_the_one_that_drifts():
    joints = standing()
    knee, ankle = GTA_IM_19.index("right_knee", "right_ankle")
    shin = joints[:, :, ankle] - joints[:, :, knee]
    bent = joints.clone()
    bent[:, 1:, ankle] = joints[:, 1:, knee] + shin[:, 1:].flip(-1)
    assert drift(bent) < 1e-12
    stretched = joints.clone()
    stretched[:, 1:, ankle] += 0.25 * shin[:, 1:]
    metric = BoneDrift(BONES)
    metric.update(stretched)
    expected = torch.zeros(len(BONES), dtype=torch.float64)
    expected[BONES.tolist().index([knee, ankle])] = 0.25
    torch.testing.assert_close(metric.each(), expected)
    torch.testing.assert_close(metric.compute(), expected.mean())


def test_jitter_changes_lengths():
    joints = standing()
    joints[:, 1:] += 0.01 * torch.randn(3, 64, 19, 3, generator=torch.manual_seed(0))
    assert 0.02 < drift(joints) < 0.3


def test_batches_make_no_difference():
    joints = standing(7) * (1 + 0.1 * torch.rand(7, 65, 1, 1))
    assert drift(joints, size=3) == pytest.approx(drift(joints), rel=1e-12)
    np.testing.assert_allclose(bone_drift(joints, BONES).mean(), drift(joints), rtol=1e-12)


def test_refuses():
    metric = BoneDrift(BONES)
    with pytest.raises(SagError, match="before any motion"):
        metric.compute()
    with pytest.raises(SagError, match="at least 19 joints, not 65 frames of 16"):
        metric.update(standing()[:, :, :16])
    with pytest.raises(SagError, match="not finite"):
        metric.update(standing() / 0 * 0)
    with pytest.raises(SagError, match="bone without length in frame 0"):
        metric.update(torch.zeros(1, 65, 19, 3))
