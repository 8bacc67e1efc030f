"""The Bayesian search: where earlier trials were good, by optuna's tree-structured Parzen estimator.

Nothing is kept but the rows themselves: a trial's point is in the status of its rows, its value in their
`metrics.json`, and optuna is told all of them anew whenever a point is wanted. So a search that was killed goes on
from what its rows have left, and does as it would have done.
"""

from __future__ import annotations

import difflib
import importlib
import json
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.sweep.command import Additions
from sag.sweep.definition import Metric, Point, Sweep
from sag.sweep.distributions import Choice, Distribution, Integers, Uniform
from sag.sweep.rows import plan
from sag.sweep.status import METRICS
from sag.sweep.tracked import Tracked, track
from sag.sweep.trials import Trial, chance_of, draw

STARTUP = 10
"""Trials that are drawn by chance before the estimator is asked, half of them all where these are few."""


@dataclass(frozen=True)
class Outcome:
    """What has become of a trial.

    Attributes:
        point: its values.
        value: of the metric, the mean over its seeds; None unless all of its rows have finished with a number.
        ended: whether none of its rows will run any more.
    """

    point: Point
    value: float | None
    ended: bool


class Search:
    """Adds rows to a sweep as others end.

    Args:
        sweep: with the method `bayes`.
        additions: what the call adds to every command.
        seeds: rows of each trial, or None for one without a seed of its own.
        out: folder of the rows.
        seed: of the search.

    Raises:
        SagError: optuna is not installed.
    """

    def __init__(self, sweep: Sweep, additions: Additions, seeds: int | None, out: Path, seed: int) -> None:
        self.sweep = sweep
        self.additions = additions
        self.seeds = seeds
        self.out = out
        self.seed = seed
        self.optuna = _optuna()

    def more(self, tracked: Sequence[Tracked], room: int) -> list[Tracked]:
        """The rows of the next trial, which wait; none where there is no room, or no trial left.

        Raises:
            SagError: a row has no figure of the metric's name.
        """
        numbers = {t.row.trial for t in tracked if t.row.trial is not None}
        if room < 1 or len(numbers) >= (self.sweep.run_cap or 0):
            return []
        number = max(numbers, default=-1) + 1
        point = self.propose(number, outcomes(self.sweep.metric, tracked))
        if point is None:
            return []
        rows = plan(self.sweep, self.additions, self.seeds, [Trial(number, point)])
        return track([row for row in rows if row.trial == number], self.out)

    def propose(self, number: int, known: Sequence[Outcome]) -> Point | None:
        """The point of a trial, given the others: by chance at first, never one that was there before."""
        chance = chance_of(self.seed, number)
        startup = min(STARTUP, max(1, (self.sweep.run_cap or 0) // 2))
        sampler = self.optuna.samplers.TPESampler(
            seed=chance.getrandbits(32), n_startup_trials=startup, constant_liar=True
        )
        maximize = self.sweep.metric is not None and self.sweep.metric.maximize
        study = self.optuna.create_study(sampler=sampler, direction="maximize" if maximize else "minimize")
        space = {name: self._space(given) for name, given in self.sweep.parameters.items()}
        for outcome in known:
            study.add_trial(self._told(outcome, space))
        asked = study.ask(space).params
        point = {name: _value(given, asked[name]) for name, given in self.sweep.parameters.items()}
        points = [outcome.point for outcome in known]
        return draw(self.sweep, chance, points) if point in points else point

    def _space(self, given: Distribution) -> Any:
        kinds = self.optuna.distributions
        if isinstance(given, Choice):  # by place: optuna takes no lists
            return kinds.CategoricalDistribution(tuple(range(len(given.values))))
        if isinstance(given, Integers):
            return kinds.IntDistribution(given.low, given.high)
        return kinds.FloatDistribution(given.low, given.high, log=given.logarithmic)

    def _told(self, outcome: Outcome, space: Mapping[str, Any]) -> Any:
        """An outcome as optuna knows it; of a trial that still runs the sampler assumes that it is no good."""
        states = self.optuna.trial.TrialState
        state = states.RUNNING if not outcome.ended else states.FAIL if outcome.value is None else states.COMPLETE
        parameters = self.sweep.parameters
        params = {name: _place(parameters[name], value) for name, value in outcome.point.items()}
        return self.optuna.trial.create_trial(
            state=state, value=outcome.value, params=params, distributions=dict(space)
        )


def _optuna() -> Any:
    try:
        optuna = importlib.import_module("optuna")
    except ImportError as error:
        raise SagError("method 'bayes' needs optuna, which is not installed; pip install 'sag[bayes]'") from error
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna


def _place(given: Distribution, value: Any) -> Any:
    return given.values.index(value) if isinstance(given, Choice) else value


def _value(given: Distribution, asked: Any) -> Any:
    if isinstance(given, Choice):
        return given.values[asked]
    return given.rounded(asked) if isinstance(given, Uniform) else asked


def outcomes(metric: Metric | None, tracked: Sequence[Tracked]) -> list[Outcome]:
    """What has become of each trial, in the order of their numbers.

    Raises:
        SagError: a row has no figure of the metric's name.
    """
    trials: dict[int, list[Tracked]] = {}
    for row in tracked:
        if row.row.trial is not None:
            trials.setdefault(row.row.trial, []).append(row)
    return [_outcome(metric, trials[number]) for number in sorted(trials)]


def _outcome(metric: Metric | None, rows: Sequence[Tracked]) -> Outcome:
    states = [row.status.state for row in rows]
    value = None
    if metric and set(states) == {"finished"}:
        figures = [figure(row.folder, metric.name) for row in rows]
        numbers = [number for number in figures if number is not None]
        value = statistics.fmean(numbers) if len(numbers) == len(figures) else None
    return Outcome(rows[0].row.point or {}, value, ended=set(states) <= {"finished", "failed"})


def figure(folder: Path, name: str) -> float | None:
    """One figure of a row that has finished; None where it was no number.

    Raises:
        SagError: there is no figure of this name.
    """
    figures = json.loads((folder / METRICS).read_text()).get("metrics", {})
    short = name.removeprefix("test/")
    if short not in figures:
        close = difflib.get_close_matches(short, figures, 1)
        hint = f"did you mean 'test/{close[0]}'?" if close else "see that file for its names"
        raise SagError(f"metric {name!r} is not in {folder / METRICS}; {hint}")
    return figures[short]
