"""The interval of Motion FID covers what it says, since it draws whole groups; windows alone would not do."""

import pytest
import torch
from clip_toys import floats
from torch import Generator, Tensor

from sag.errors import SagError
from sag.metrics import motion_fid_interval, motion_fid_of_features
from sag.metrics.fid.clips import picked

GROUPS, WINDOWS, DIMENSION = 36, 6, 4
GROUP = torch.arange(GROUPS).repeat_interleave(WINDOWS)


def clustered(draw: Generator, shift: float) -> tuple[dict, dict]:
    """Generated and real features; windows of one group are alike, and both sides of a window are a little."""

    def noise(*shape: int) -> Tensor:
        return torch.randn(*shape, DIMENSION, generator=draw, dtype=torch.float64)

    own, generated = noise(GROUPS), noise(GROUPS)
    of_group = own * 0.8, (0.4 * own + 0.7 * generated) + shift
    real, made = (place[GROUP] + 0.6 * noise(len(GROUP)) for place in of_group)
    return {(16, 2): 1.2 * made[:, None]}, {(16, 2): real[:, None]}


@pytest.fixture(autouse=True)
def only_short(monkeypatch):
    monkeypatch.setattr("sag.metrics.fid.clips.GROUPS", {"short": (2,)})


def covered(shift: float, group: Tensor, trials: int = 50) -> int:
    """How many of the intervals of so many sets of recordings hold the mean figure of all such sets."""
    draw = torch.manual_seed(0)
    truth = torch.stack([motion_fid_of_features(*clustered(draw, shift))["short"] for _ in range(300)]).mean()
    found = [motion_fid_interval(*clustered(draw, shift), group, resamples=40)["short"] for _ in range(trials)]
    return sum(each.low <= truth <= each.high for each in found)


@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_covers_the_figure_that_other_recordings_have(shift):
    assert covered(shift, GROUP) >= 42, "95 % of 50 is 47.5; of 40 resamples 90 %; fewer than 42 are rare"


def test_windows_one_by_one_would_be_too_narrow():
    assert covered(0.5, torch.arange(len(GROUP))) <= 38


def test_lies_around_the_figure_and_is_repeatable():
    features = clustered(torch.manual_seed(0), 0.5)
    figure = floats(motion_fid_of_features(*features))["short"]
    first = motion_fid_interval(*features, GROUP)["short"]
    assert 0 <= first.low < figure < first.high
    assert first == motion_fid_interval(*features, GROUP)["short"]
    assert first != motion_fid_interval(*features, GROUP, seed=1)["short"]
    inner = motion_fid_interval(*features, GROUP, level=0.5)["short"]
    assert first.low < inner.low < inner.high < first.high


def test_of_equal_sets_it_is_nothing_but_zero():
    _, real = clustered(torch.manual_seed(0), 0)
    found = motion_fid_interval(real, real, GROUP, resamples=20)["short"]
    assert found.low == pytest.approx(0, abs=1e-9) and found.high == pytest.approx(0, abs=1e-9)


def test_order_and_names_of_groups_make_no_difference_and_which_belong_together_does():
    generated, real = clustered(torch.manual_seed(0), 0.3)
    plain = motion_fid_interval(generated, real, GROUP)["short"]
    assert motion_fid_interval(generated, real, 7 * GROUP + 3)["short"] == plain
    mixed = motion_fid_interval(generated, real, GROUP[torch.randperm(len(GROUP))])["short"]
    assert mixed.high - mixed.low < 0.8 * (plain.high - plain.low)


def test_sums_and_weighted_clips_are_the_same(monkeypatch):
    features = clustered(torch.manual_seed(0), 0.5)
    by_sums = motion_fid_interval(*features, GROUP, resamples=20)["short"]
    monkeypatch.setattr("sag.metrics.fid.resampling._MOST_SUMS", 0)
    assert motion_fid_interval(*features, GROUP, resamples=20)["short"] == pytest.approx(by_sums, rel=1e-9)


def test_refuses():
    generated, real = clustered(torch.manual_seed(0), 0)
    with pytest.raises(SagError, match="equally many"):
        motion_fid_interval(picked(generated, slice(9)), real, GROUP)
    with pytest.raises(SagError, match="group of each of 216 motions, not 9"):
        motion_fid_interval(generated, real, GROUP[:9])
    with pytest.raises(SagError, match="at least 2 groups"):
        motion_fid_interval(generated, real, torch.zeros_like(GROUP))
    with pytest.raises(SagError, match="2 resamples or more and a level"):
        motion_fid_interval(generated, real, GROUP, resamples=1)
