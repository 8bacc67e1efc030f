"""Acceleration and jerk: exact for polynomials, blind to what has none, alert to jitter."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from sag.errors import SagError
from sag.metrics.motion.smoothness import Acceleration, Jerk, mean_derivative

FPS = 30.0


def path(*coefficients: float, fps: float = FPS) -> Tensor:
    """Joints that all move along x by a polynomial of time."""
    time = torch.arange(65).double() / fps
    joints = torch.zeros(2, 65, 19, 3, dtype=torch.float64)
    joints[..., 0] = sum(c * time**power for power, c in enumerate(coefficients))[:, None]  # type: ignore[index]
    return joints


def figure(kind: type[Acceleration] | type[Jerk], joints: Tensor, fps: float = FPS) -> float:
    metric = kind(fps)
    for part in joints.split(3):
        metric.update(part)
    return float(metric.compute())


@given(start=st.floats(-3, 3), speed=st.floats(-3, 3), half=st.floats(-5, 5), fps=st.sampled_from([5.0, 25.0, 30.0]))
@settings(max_examples=30, deadline=None)
def test_exact_for_a_constant_acceleration_at_any_rate(start, speed, half, fps):
    joints = path(start, speed, half, fps=fps)
    assert figure(Acceleration, joints, fps) == pytest.approx(2 * abs(half), abs=1e-9)
    assert figure(Jerk, joints, fps) == pytest.approx(0, abs=1e-7)


def test_exact_for_a_constant_jerk():
    assert figure(Jerk, path(1, 2, 3, 4)) == pytest.approx(24)


@pytest.mark.parametrize(("kind", "expected"), [(Acceleration, 35.2), (Jerk, 1927)])
def test_a_centimetre_of_jitter_is_seen_over_any_motion(kind, expected):
    noise = 0.01 * torch.randn(50, 65, 19, 3, generator=torch.manual_seed(0), dtype=torch.float64)
    assert figure(kind, noise) == pytest.approx(expected, rel=0.02)
    assert figure(kind, noise + path(1, 2)[:1]) == pytest.approx(figure(kind, noise))


def test_a_jump_from_the_given_frame_counts():
    joints = path(0)
    joints[:, 0, :, 2] += 0.1
    assert figure(Acceleration, joints) == pytest.approx(0.1 * FPS**2 / 63)
    assert figure(Jerk, joints) == pytest.approx(0.1 * FPS**3 / 62)


def test_another_frame_makes_no_difference_and_batches_neither():
    motions = torch.randn(7, 65, 19, 3, dtype=torch.float64)
    rotation = torch.linalg.qr(torch.randn(3, 3, dtype=torch.float64))[0]
    expected = float(mean_derivative(motions, 2, FPS).mean())
    assert figure(Acceleration, motions) == pytest.approx(expected, rel=1e-12)
    assert figure(Acceleration, motions @ rotation + 5) == pytest.approx(expected)


@pytest.mark.parametrize("kind", [Acceleration, Jerk])
def test_refuses(kind):
    name = kind.__name__.lower()
    with pytest.raises(SagError, match=r"fps of .* must be above 0, not 0"):
        kind(0)
    metric = kind(FPS)
    with pytest.raises(SagError, match=f"{name} was asked for before any motion"):
        metric.compute()
    with pytest.raises(SagError, match=f"{name} needs 65 frames"):
        metric.update(path(0)[:, 1:])
    with pytest.raises(SagError, match="not finite"):
        metric.update(path(0) / 0)
