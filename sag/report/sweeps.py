"""Several sweeps in one report: their runs together, with names that tell them apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from sag.errors import SagError
from sag.report.lines import without_seed
from sag.report.results import GROUND_TRUTH, PREPARATIONS, Result, read_results


def read_sweeps(folders: Sequence[Path]) -> list[Result]:
    """The runs of one folder, or of several.

    Where no row stands in two folders, their rows are as if of one sweep. Where one does, all rows are called by their
    sweep too. A ground truth of the same figures is kept once.

    Raises:
        SagError: a folder holds no finished row or is named twice.
    """
    sweeps = {name: read_results(folder) for name, folder in zip(sweep_names(folders), folders)}
    truths = [(name, r) for name, results in sweeps.items() for r in results if r.name == GROUND_TRUTH]
    is_one_truth = all(_agree(truths[0][1], truth) for _, truth in truths[1:])
    shared = _shared_rows(sweeps)
    runs = []
    for sweep, results in sweeps.items():
        for run in results:
            if run.name == GROUND_TRUTH and is_one_truth:
                runs += [run] if sweep == truths[0][0] else []
            else:
                runs.append(replace(run, sweep=sweep) if shared or run.name == GROUND_TRUTH else run)
    return runs


def sweep_names(folders: Sequence[Path]) -> list[str]:
    """Names of sweeps: their folders', with as many folders above as it takes to tell them apart.

    Raises:
        SagError: a folder is named twice.
    """
    paths = [folder.resolve() for folder in folders]
    if len(set(paths)) < len(paths):
        twice = next(folder for folder, path in zip(folders, paths) if paths.count(path) > 1)
        raise SagError(f"{twice} is named twice; name each folder once")
    depth = 1
    while len({path.parts[-depth:] for path in paths}) < len(paths):
        depth += 1
    return ["/".join(path.parts[-depth:]) for path in paths]


def _shared_rows(sweeps: dict[str, list[Result]]) -> set[str]:
    """Rows that stand in several sweeps."""
    seen: set[str] = set()
    shared: set[str] = set()
    for results in sweeps.values():
        rows = {without_seed(run.name) for run in results} - {GROUND_TRUTH, *PREPARATIONS}
        shared |= seen & rows
        seen |= rows
    return shared


def _agree(one: Result, other: Result) -> bool:
    """Whether two runs have the same figures, up to what another machine rounds otherwise."""
    names = set(one.metrics)
    return names == set(other.metrics) and all(
        math.isclose(one.metrics[n], other.metrics[n], rel_tol=1e-3, abs_tol=1e-4)
        or (math.isnan(one.metrics[n]) and math.isnan(other.metrics[n]))
        for n in names
    )
