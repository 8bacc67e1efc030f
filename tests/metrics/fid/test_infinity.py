"""Motion FID for infinite N is nearer the truth than the plain one, on Gaussians whose distance is known."""

import pytest
import torch
from clip_toys import floats, gaussian_features

from sag.errors import SagError
from sag.metrics import motion_fid_infinity, motion_fid_of_features
from sag.metrics.fid.clips import picked

DIMENSION = 8


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_is_nearer_the_truth(shift):
    draw, truth = torch.manual_seed(0), DIMENSION * shift**2
    plain, found = [], []
    for _ in range(10):
        real = gaussian_features(draw, 120, DIMENSION)
        generated = gaussian_features(draw, 120, DIMENSION, shift)
        plain.append(floats(motion_fid_of_features(generated, real))["average"])
        found.append(floats(motion_fid_infinity(generated, real))["average"])
    plain_error, error = (torch.tensor(x).sub(truth).mean().abs() for x in (plain, found))
    assert error < plain_error / 4
    assert all(figure < above for figure, above in zip(found, plain))


def test_whole_groups_say_what_windows_hide():
    """Ten windows of a group are the same: more windows are no more data, and only more groups are."""
    draw, group = torch.manual_seed(0), torch.arange(60).repeat_interleave(10)
    found = []
    for _ in range(8):
        few = gaussian_features(draw, 60, 3), gaussian_features(draw, 60, 3)
        sides = [picked(side, group) for side in few]
        figures = motion_fid_of_features(*sides), motion_fid_infinity(*sides), motion_fid_infinity(*sides, group)
        found.append([floats(figure)["average"] for figure in figures])
    plain, by_window, by_group = torch.tensor(found).mean(0)
    assert by_window > 0.8 * plain
    assert abs(by_group) < 0.4 * plain


def test_of_equal_sets_is_zero_and_is_repeatable():
    draw = torch.manual_seed(0)
    real, generated = gaussian_features(draw, 40), gaussian_features(draw, 40)
    assert floats(motion_fid_infinity(real, real)) == pytest.approx(
        dict.fromkeys(floats(motion_fid_infinity(real, real)), 0), abs=1e-9
    )
    assert motion_fid_infinity(generated, real) == motion_fid_infinity(generated, real)
    assert motion_fid_infinity(generated, real) != motion_fid_infinity(generated, real, seed=1)
    assert set(motion_fid_infinity(generated, real)) == {"short", "mid", "long", "average"}


@pytest.mark.parametrize("motions", [4, 5, 7, 13, 100])
def test_any_number_of_motions_can_be_split(motions):
    draw = torch.manual_seed(0)
    found = motion_fid_infinity(gaussian_features(draw, motions, 2), gaussian_features(draw, motions, 2))
    assert all(torch.isfinite(value) for value in found.values())


def test_refuses():
    draw = torch.manual_seed(0)
    real = gaussian_features(draw, 8)
    with pytest.raises(SagError, match="equally many"):
        motion_fid_infinity(picked(real, slice(4)), real)
    with pytest.raises(SagError, match="at least 4 motions"):
        motion_fid_infinity(*[picked(real, slice(3))] * 2)
    with pytest.raises(SagError, match="of 2 groups"):
        motion_fid_infinity(real, real, torch.zeros(8, dtype=torch.long))
    with pytest.raises(SagError, match="group of each of 8 motions, not 2"):
        motion_fid_infinity(real, real, torch.arange(2))
