"""A sweep file: W&B's sweep format, so that the same YAML also runs under `wandb sweep`.

Read here: https://docs.wandb.ai/guides/sweeps/define-sweep-configuration, grid search only.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from sag.errors import SagError

KEYS = ("program", "name", "description", "project", "entity", "method", "metric", "command", "parameters")
"""Keys of a sweep file; `project`, `entity` and `metric` speak to W&B's server alone."""

DEFAULT_COMMAND = ("${env}", "${interpreter}", "${program}", "${args}")
"""W&B's command where a file has none."""

Point = dict[str, Any]
"""One point of the grid: parameter to value."""


@dataclass(frozen=True)
class Sweep:
    """A sweep file that has been read and found right.

    Attributes:
        path: the file.
        name: what reports and W&B's group call it.
        program: what `${program}` stands for.
        command: the parts of the command, W&B's macros among them.
        parameters: values of each parameter, in the order of the file.
    """

    path: Path
    name: str
    program: str
    command: tuple[str, ...]
    parameters: dict[str, list[Any]]

    def points(self) -> list[Point]:
        """Every combination of the values; the last parameter changes fastest."""
        return [dict(zip(self.parameters, values)) for values in itertools.product(*self.parameters.values())]

    @property
    def varied(self) -> list[str]:
        """Parameters with more than one value: those that tell rows apart."""
        return [name for name, values in self.parameters.items() if len(values) > 1]


def read_sweep(path: Path) -> Sweep:
    """The sweep that a file describes.

    Raises:
        SagError: the file is missing, is no YAML, or asks for what is not run here.
    """
    content = _read(path)
    unknown = sorted(set(content) - set(KEYS))
    if unknown:
        raise SagError(f"{path}: unknown key {unknown[0]!r}; a sweep file has {', '.join(KEYS)}")
    if content.get("method", "grid") != "grid":
        raise SagError(f"{path}: method {content['method']!r} is not run here; use 'grid', or `wandb sweep` for it")
    command = tuple(str(part) for part in content.get("command") or DEFAULT_COMMAND)
    if "${program}" in command and "program" not in content:
        raise SagError(f"{path}: the command says ${{program}} and the file has no 'program'; add it")
    return Sweep(
        path=path,
        name=str(content.get("name") or path.stem),
        program=str(content.get("program", "")),
        command=command,
        parameters=_parameters(path, content.get("parameters")),
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


def _parameters(path: Path, parameters: Any) -> dict[str, list[Any]]:
    if not isinstance(parameters, dict) or not parameters:
        raise SagError(f"{path}: 'parameters' must map each parameter to {{value: x}} or {{values: [x, y]}}")
    return {str(name): _values(path, name, given) for name, given in parameters.items()}


def _values(path: Path, name: str, given: Any) -> list[Any]:
    """Values of one parameter: a grid knows `value` and `values` alone."""
    if isinstance(given, dict) and list(given) == ["value"]:
        return [given["value"]]
    if isinstance(given, dict) and list(given) == ["values"] and isinstance(given["values"], list) and given["values"]:
        return list(given["values"])
    raise SagError(f"{path}: parameter {name!r} must be {{value: x}} or {{values: [x, y]}} in a grid, found {given!r}")
