"""Random halves: whole groups, equally many motions, any split as likely as another."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from sag.errors import SagError
from sag.metrics.halves import random_halves

sizes_of_groups = st.lists(st.integers(1, 9), min_size=2, max_size=12)


def groups(sizes: list[int], seed: int = 0) -> torch.Tensor:
    """The group of each motion, in any order and under any names."""
    group = (7 * torch.arange(len(sizes)) - 20).repeat_interleave(torch.tensor(sizes))
    return group[torch.randperm(len(group), generator=torch.manual_seed(seed))]


@given(sizes=sizes_of_groups, seed=st.integers(0, 99))
@settings(max_examples=60, deadline=None)
def test_halves_are_of_whole_groups_and_equally_many(sizes, seed):
    group = groups(sizes, seed)
    for side in random_halves(group, splits=3, seed=seed):
        first, second = (group[side == name] for name in (0, 1))
        assert len(first) == len(second) > 0
        assert not set(first.tolist()) & set(second.tolist())
        assert int((side == -1).sum()) == len(group) - 2 * len(first)


@given(sizes=sizes_of_groups)
@settings(max_examples=40, deadline=None)
def test_no_more_is_left_out_than_the_largest_group_has(sizes):
    left_out = (random_halves(groups(sizes)) == -1).sum(1)
    assert int(left_out.max()) <= max(sizes)


def test_every_pair_of_groups_is_on_one_side_as_often_as_chance_has_it():
    side = random_halves(torch.arange(6), splits=3000)
    together = (side[:, :, None] == side[:, None, :]).double().mean(0)
    pairs = together[~torch.eye(6, dtype=torch.bool)]
    assert pairs.sub(0.4).abs().max() < 0.05, "of five others two are on the side of the first; twins are no exception"


def test_which_motions_are_left_out_is_left_to_chance():
    side = random_halves(torch.tensor([0] * 12 + [1] * 4), splits=2000)
    assert (side[:, 12:] >= 0).all()
    assert (side[:, :12] == -1).double().mean(0).sub(8 / 12).abs().max() < 0.06


def test_is_repeatable_and_splits_differ():
    group = groups([3] * 10)
    assert torch.equal(random_halves(group), random_halves(group))
    assert not torch.equal(random_halves(group), random_halves(group, seed=1))
    assert torch.equal(random_halves(group, splits=8)[:3], random_halves(group, splits=3))
    assert len(random_halves(group).unique(dim=0)) == 8


def test_refuses():
    for group in (torch.zeros(5, dtype=torch.long), torch.zeros(0, dtype=torch.long)):
        with pytest.raises(SagError, match="motions of 2 or more"):
            random_halves(group)
    with pytest.raises(SagError, match="splits to be 1 or more, not 0"):
        random_halves(torch.arange(4), splits=0)
