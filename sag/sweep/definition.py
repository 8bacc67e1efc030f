"""A sweep file: W&B's sweep format, so that the same YAML also runs under `wandb sweep`.

Read here: https://docs.wandb.ai/guides/sweeps/define-sweep-configuration
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import yaml

from sag.errors import SagError
from sag.sweep.distributions import Choice, Distribution, read_distribution

KEYS = ("program", "name", "description", "project", "entity", "method", "metric", "run_cap", "command", "parameters")
"""Keys of a sweep file; `project` and `entity` speak to W&B's server alone."""

Method = Literal["grid", "random", "bayes"]
"""How points are found: all of a grid, drawn, or drawn where earlier ones were good."""

GOALS = ("minimize", "maximize")

DEFAULT_COMMAND = ("${env}", "${interpreter}", "${program}", "${args}")
"""W&B's command where a file has none."""

Point = dict[str, Any]
"""One point of the grid or of a search: parameter to value."""


@dataclass(frozen=True)
class Metric:
    """What a search is after.

    Attributes:
        name: of the figure, as W&B logs it; `metrics.json` has it without `test/`.
        maximize: whether more is better.
    """

    name: str
    maximize: bool = False


@dataclass(frozen=True)
class Sweep:
    """A sweep file that has been read and found right.

    Attributes:
        path: the file.
        name: what reports and W&B's group call it.
        program: what `${program}` stands for.
        command: the parts of the command, W&B's macros among them.
        parameters: what each parameter may be, in the order of the file.
        method: how points are found.
        run_cap: how many points there are at most; None in a grid for all of them.
        metric: what a Bayesian search is after.
    """

    path: Path
    name: str
    program: str
    command: tuple[str, ...]
    parameters: dict[str, Distribution]
    method: Method = "grid"
    run_cap: int | None = None
    metric: Metric | None = None

    def points(self) -> list[Point]:
        """Every combination of a grid's values; the last parameter changes fastest."""
        choices = [given.values for given in self.parameters.values() if isinstance(given, Choice)]
        return [dict(zip(self.parameters, values)) for values in itertools.product(*choices)][: self.run_cap]

    @property
    def varied(self) -> list[str]:
        """Parameters with more than one value: those that tell rows apart."""
        return [n for n, given in self.parameters.items() if not isinstance(given, Choice) or len(given.values) > 1]


def read_sweep(path: Path) -> Sweep:
    """The sweep that a file describes.

    Raises:
        SagError: the file is missing, is no YAML, or asks for what is not run here.
    """
    content = _read(path)
    unknown = sorted(set(content) - set(KEYS))
    if unknown:
        raise SagError(f"{path}: unknown key {unknown[0]!r}; a sweep file has {', '.join(KEYS)}")
    command = tuple(str(part) for part in content.get("command") or DEFAULT_COMMAND)
    if "${program}" in command and "program" not in content:
        raise SagError(f"{path}: the command says ${{program}} and the file has no 'program'; add it")
    method = _method(path, content)
    return Sweep(
        path=path,
        name=str(content.get("name") or path.stem),
        program=str(content.get("program", "")),
        command=command,
        parameters=_parameters(path, content.get("parameters"), method),
        method=method,
        run_cap=_run_cap(path, content.get("run_cap"), method),
        metric=_metric(path, content.get("metric")) if method == "bayes" else None,
    )


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise SagError(f"sweep file {path} does not exist; see sweeps/ for those that do")
    try:
        content = yaml.safe_load(path.read_text())
    except yaml.YAMLError as error:
        raise SagError(f"{path} is not valid YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise SagError(f"{path}: a sweep file is a mapping with the keys {', '.join(KEYS)}")
    return content


def _method(path: Path, content: dict[str, Any]) -> Method:
    method = content.get("method", "grid")
    if method not in get_args(Method):
        raise SagError(f"{path}: method {method!r} is not known; use one of {', '.join(get_args(Method))}")
    return method


def _run_cap(path: Path, given: Any, method: Method) -> int | None:
    """How many points; a search without an end is not begun."""
    if given is None and method == "grid":
        return None
    if not isinstance(given, int) or isinstance(given, bool) or given < 1:
        raise SagError(f"{path}: method {method!r} needs run_cap, how many points to try, above 0; found {given!r}")
    return given


def _metric(path: Path, given: Any) -> Metric:
    goal = given.get("goal", "minimize") if isinstance(given, dict) else None
    if not isinstance(given, dict) or not isinstance(given.get("name"), str) or goal not in GOALS:
        raise SagError(
            f"{path}: method 'bayes' needs metric, such as {{name: test/motion_fid/average, goal: minimize}}, "
            f"found {given!r}"
        )
    return Metric(given["name"], maximize=goal == "maximize")


def _parameters(path: Path, parameters: Any, method: Method) -> dict[str, Distribution]:
    if not isinstance(parameters, dict) or not parameters:
        raise SagError(f"{path}: 'parameters' must map each parameter to {{value: x}} or {{values: [x, y]}}")
    return {str(name): _parameter(path, name, given, method) for name, given in parameters.items()}


def _parameter(path: Path, name: str, given: Any, method: Method) -> Distribution:
    """What one parameter may be: a grid knows `value` and `values` alone."""
    try:
        read = read_distribution(given)
    except ValueError as error:
        raise SagError(f"{path}: parameter {name!r} {error}") from error
    if method == "grid" and not isinstance(read, Choice):
        raise SagError(
            f"{path}: parameter {name!r} has no values that a grid could go through; name some, or use random"
        )
    return read
