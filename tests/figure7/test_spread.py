from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest
import torch

from sag.errors import SagError
from sag.figure7.spread import TRAJECTORIES, Spread, TakesEnd, common_ends, nearest, spreads_of
from sag.methods.base import Method
from sag.runs import Run
from sag.scoring import Evaluation
from sag.types import Batch, Motion


class Walker(Method):
    """Draws straight ways to ends around the start."""

    def __init__(self) -> None:
        super().__init__("gta_im_19", Evaluation())

    def sample(self, batch: Batch, generator: torch.Generator | None = None) -> Motion:
        return self._straight(batch, torch.randn(len(batch), 1, 3, generator=generator))

    def _straight(self, batch: Batch, ends: torch.Tensor) -> Motion:
        way = ends * torch.arange(1, 65)[None, :, None] / 64
        return batch.motion.first.continued(way, batch.motion.pose[:, 1:])


class Obedient(Walker):
    """Goes straight to where it is told."""

    def sample_to(self, batch: Batch, goals: torch.Tensor) -> Motion:
        return self._straight(batch, (goals - batch.motion.start)[:, None])


class Moody(Walker):
    """Is told an end, but goes there by chance."""

    def sample_to(self, batch: Batch, goals: torch.Tensor) -> Motion:
        return self._straight(batch, (goals - batch.motion.start)[:, None] + torch.randn(len(batch), 1, 3))


@dataclass
class Runs:
    """Runs of made-up methods on toy data."""

    toy: Any

    def of(self, **methods: Walker) -> list[Run]:
        return [Run(name, method, self.toy) for name, method in methods.items()]


@pytest.fixture
def runs(toy) -> Runs:
    return Runs(toy)


def spreads(runs: list[Run], batch: Batch, samples: int = 50, end: str = "densest") -> list[Spread]:
    return spreads_of(runs, [batch], samples, 0, end)  # type: ignore[arg-type]


def test_the_densest_end_is_where_five_are_near_each_other() -> None:
    scattered = 5 * torch.randn(1, 30, 3)
    crowd = torch.tensor([[[20.0, 0, 0]]]) + 0.01 * torch.randn(1, TRAJECTORIES, 3)
    chosen = common_ends([torch.cat([scattered, crowd], dim=1)])
    assert (chosen - torch.tensor([[20.0, 0, 0]])).norm() < 0.05


def test_four_are_no_crowd() -> None:
    few = torch.tensor([[[20.0, 0, 0]]]).expand(1, TRAJECTORIES - 1, 3)
    many = torch.tensor([[[-20.0, 0, 0]]]) + 0.1 * torch.randn(1, TRAJECTORIES, 3)
    assert common_ends([torch.cat([few, many], dim=1)])[0, 0] < 0


def test_a_common_end_suits_every_method() -> None:
    place = torch.tensor([[[3.0, 0, 0]]])
    own = [place + side * 5 + 0.001 * torch.randn(1, 6, 3) for side in (-1, 1)]
    shared = [place + 0.1 * torch.randn(1, 6, 3) for _ in range(2)]
    chosen = common_ends([torch.cat(pair, dim=1) for pair in zip(own, shared)])
    assert (chosen - place[0]).norm() < 0.5


def test_the_nearest_five_are_taken() -> None:
    roots = torch.zeros(1, 8, 65, 3)
    roots[0, :, -1, 0] = torch.tensor([7.0, 1, 6, 2, 5, 3, 4, 0])
    found = nearest(roots, torch.zeros(1, 3))
    assert found[0, :, -1, 0].tolist() == [0, 1, 2, 3, 4]


def test_whoever_is_told_his_end_has_no_deviation(runs: Runs, batch: Batch) -> None:
    drawn, told = spreads(runs.of(walker=Walker(), obedient=Obedient()), batch)
    assert told.told and not told.curve.any() and told.misses.max() < 1e-5
    assert not drawn.told and drawn.curve[0] == 0 and (drawn.curve[1:] > 0).all()
    assert torch.equal(drawn.ends, told.ends)


def test_chance_in_a_method_that_is_told_shows(runs: Runs, batch: Batch) -> None:
    _, told = spreads(runs.of(walker=Walker(), moody=Moody()), batch)
    assert told.curve[-1] > 0.3


def test_more_samples_end_nearer_to_each_other(runs: Runs, batch: Batch) -> None:
    few, many = (spreads(runs.of(walker=Walker()), batch, samples)[0] for samples in (8, 300))
    assert many.misses.median() < few.misses.median() / 2
    assert many.curve[-1] < few.curve[-1]


def test_deviation_is_that_of_the_five(runs: Runs, batch: Batch) -> None:
    (found,) = spreads(runs.of(walker=Walker()), batch)
    places = found.roots[0, :, 32].double()
    assert found.deviations[0, 32].item() == pytest.approx(places.var(dim=0, unbiased=False).sum().sqrt().item())
    assert torch.allclose(found.curve, found.deviations.mean(dim=0))


def test_the_true_end_is_the_data_sets(runs: Runs, batch: Batch) -> None:
    found, _ = spreads(runs.of(walker=Walker(), obedient=Obedient()), batch, end="true")
    assert torch.equal(found.ends, batch.motion.roots[:, -1])


def test_one_seed_gives_one_figure(runs: Runs, batch: Batch) -> None:
    first, again = (spreads(runs.of(walker=Walker()), batch)[0] for _ in range(2))
    assert torch.equal(first.roots, again.roots)


def test_the_random_state_is_left_alone(runs: Runs, batch: Batch) -> None:
    before = torch.random.get_rng_state()
    spreads(runs.of(walker=Walker(), moody=Moody()), batch)
    assert torch.equal(before, torch.random.get_rng_state())


def test_methods_are_told_apart_by_what_they_can_do() -> None:
    assert isinstance(Obedient(), TakesEnd)
    assert not isinstance(Walker(), TakesEnd)
    assert not isinstance(SimpleNamespace(), TakesEnd)


def test_impossible_wishes_are_refused(runs: Runs, batch: Batch) -> None:
    with pytest.raises(SagError, match="--samples is 4"):
        spreads(runs.of(walker=Walker()), batch, samples=4)
    with pytest.raises(SagError, match="--end true"):
        spreads(runs.of(obedient=Obedient()), batch)
    assert len(spreads(runs.of(obedient=Obedient()), batch, end="true")) == 1


def test_windows_are_spread_over_all(runs: Runs) -> None:
    (run,) = runs.of(walker=Walker())
    count = len(run.data.cache.rows("test"))
    (batch,) = run.windows(2)
    rows = run.data.cache.rows("test")
    assert batch.index.tolist() == [rows[0], rows[-1]]
    for wrong in (0, count + 1):
        with pytest.raises(SagError, match="--windows"):
            run.windows(wrong)
