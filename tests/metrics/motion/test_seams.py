"""Seams: what is counted to them, exact figures for known faults, and nothing where there is none."""

import pytest
import torch
from torch import Tensor

from sag.errors import SagError
from sag.metrics.motion.seams import SeamJerk, seam_jerks, velocity_jumps
from sag.metrics.motion.smoothness import mean_derivative

FPS, ROOT = 30.0, 12


def cubic(frames: int = 129) -> Tensor:
    """Motions of constant jerk 6 m/s^3 along x."""
    joints = torch.zeros(2, frames, 19, 3, dtype=torch.float64)
    joints[..., 0] = (torch.arange(frames).double() / FPS)[:, None] ** 3
    return joints


def figures(joints: Tensor, **options) -> dict[str, float]:
    metric = SeamJerk(ROOT, FPS, **options)
    for part in joints.split(1):
        metric.update(part)
    return {name: float(value) for name, value in metric.compute().items()}


def test_a_motion_without_a_fault_has_ratio_one():
    found = figures(cubic(), seams=[64])
    assert found["jerk_inside"] == pytest.approx(6) and found["jerk_ratio"] == pytest.approx(1)
    assert found["jump_at_seams"] == pytest.approx(6 * 64 / FPS**2, rel=0.02)


def test_every_four_frames_are_inside_or_at_a_seam_but_the_first():
    noise = torch.randn(3, 200, 19, 3, dtype=torch.float64)
    for seams, overlap in (((64, 128), 1), ((57, 114, 171), 8), ((64,), 32)):
        inside, at_seams = seam_jerks(noise, seams, overlap, FPS)
        assert at_seams.shape[1] == len(seams) * (overlap + 2)
        total = inside.sum(1) + at_seams.sum(1) + noise[:, :4].diff(3, dim=1).norm(dim=-1).mean((1, 2)) * FPS**3
        assert torch.allclose(total, 197 * mean_derivative(noise, 3, FPS))


@pytest.mark.parametrize("overlap", [1, 8])
@pytest.mark.parametrize("frame", range(60, 76))
def test_a_jump_within_the_seam_is_the_seams_and_no_other(frame, overlap):
    joints = torch.zeros(1, 129, 19, 3)
    joints[:, frame:, :, 1] = 0.1
    found = figures(joints, seams=[64], overlap=overlap)
    belongs = 64 < frame <= 64 + overlap
    assert (found["jerk_inside"] == 0) == belongs
    if belongs:
        assert found["jerk_at_seams"] == pytest.approx(0.1 * 4 / (overlap + 2) * FPS**3)
        assert found["jump_at_seams"] == pytest.approx(0.1 * FPS)


def test_the_jump_is_the_roots_alone():
    joints = torch.zeros(1, 129, 19, 3)
    joints[:, 65:, :ROOT, 1] = 0.1
    assert figures(joints, seams=[64])["jump_at_seams"] == 0
    assert figures(joints, seams=[64])["jerk_at_seams"] > 0


def test_a_jump_off_the_given_frame_is_neither():
    joints = torch.zeros(1, 129, 19, 3)
    joints[:, 1:, :, 2] = 0.1
    found = figures(joints, seams=[64], overlap=8)
    assert (found["jerk_inside"], found["jerk_at_seams"], found["jump_inside"], found["jump_at_seams"]) == (0, 0, 0, 0)


def test_jumps_of_white_noise_are_alike_inside_and_at_seams():
    roots = torch.randn(400, 257, 3, generator=torch.manual_seed(0), dtype=torch.float64)
    for seams, overlap in (((64, 128, 192), 1), ((57, 114, 171, 228), 8)):
        inside, at_seams = velocity_jumps(roots, seams, overlap, FPS)
        assert float(at_seams.mean()) == pytest.approx(float(inside.mean()), rel=0.02)


def test_motions_may_end_within_the_last_seam():
    found = figures(torch.randn(1, 66, 19, 3), seams=[57], overlap=8)
    assert all(value > 0 for value in found.values())


def test_without_a_seam_there_is_only_the_inside():
    found = figures(cubic(65), seams=[])
    assert found["jerk_inside"] == pytest.approx(6) and found["jump_inside"] > 0
    assert all(found[name] != found[name] for name in ("jerk_at_seams", "jerk_ratio", "jump_at_seams"))


def test_refuses():
    for options in ({"seams": [0]}, {"seams": [64], "overlap": 0}):
        with pytest.raises(SagError, match="both must be 1 or more"):
            SeamJerk(ROOT, FPS, **options)
    with pytest.raises(SagError, match="fps of seam jerk must be above 0"):
        SeamJerk(ROOT, 0, seams=[64])
    metric = SeamJerk(ROOT, FPS, seams=[64, 128])
    with pytest.raises(SagError, match="seam jerk was asked for before any motion"):
        metric.compute()
    with pytest.raises(SagError, match="needs at least 130 frames for its seams, not 129"):
        metric.update(cubic())
    with pytest.raises(SagError, match="not finite"):
        metric.update(cubic(200) / 0)
