"""Results: what the runs of a folder have left there, whether or not they can stand in one table."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.letters import components_of

PREPARATIONS = ("encoders",)
"""Runs of a sweep that leave no figures."""

GROUND_TRUTH = "ground_truth"
"""The run that scores the true motion."""

BLIND = "blind"
"""The row whose scene feature is zero; what its name begins with where there are several."""


SHEET = "samples.png"
"""The contact sheet of a run."""


@dataclass(frozen=True)
class Result:
    """One run, finished or not.

    Attributes:
        name: its folder.
        state: `finished`, or what the sweep says of it.
        reason: why it has no figures.
        method: class of its method.
        components: component to on or off; None for a method without.
        seed: of its random numbers.
        data: the data set's description of itself.
        protocol: what the figures were measured with.
        metrics: its figures.
        steps: generator steps trained.
        seconds: time of `fit` and `test`.
        parameters: numbers that were trained.
        origin: versions and commit.
        pretrained: checkpoint of other data in which training started, if it did.
        sheet: its contact sheet, a small PNG, if it left one.
        sweep: where it comes from, if runs of several sweeps stand in one report and share names.
    """

    name: str
    state: str = "finished"
    reason: str = ""
    method: str = ""
    components: dict[str, bool] | None = None
    seed: int | None = None
    data: dict[str, Any] = field(default_factory=dict)
    protocol: dict[str, Any] = field(default_factory=dict)
    metrics: dict[str, float] = field(default_factory=dict)
    steps: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    parameters: int = 0
    origin: dict[str, Any] = field(default_factory=dict)
    pretrained: str | None = None
    sheet: Path | None = None
    sweep: str = ""

    @property
    def label(self) -> str:
        """The name, with its sweep where that is needed to tell runs apart."""
        return f"{self.name} ({self.sweep})" if self.sweep else self.name

    @property
    def finished(self) -> bool:
        """Whether it has figures."""
        return self.state == "finished"


def read_results(folder: Path) -> list[Result]:
    """Every run under a folder, by name.

    Raises:
        SagError: there is none that has finished, or a file cannot be read.
    """
    if not folder.is_dir():
        raise SagError(f"{folder} is no folder; give the one that a sweep wrote, such as runs/ablation")
    results = [result for run in run_folders(folder) if (result := _read(run))]
    if not any(result.finished for result in results):
        tried = f"; {results[0].name}: {results[0].reason}" if results else ""
        raise SagError(f"{folder} holds no finished row (<row>/metrics.json); run `sag sweep` first{tried}")
    return results


def run_folders(folder: Path) -> list[Path]:
    """The folders of all runs in a sweep's folder, finished or not."""
    return sorted({path.parent for name in ("metrics.json", "status.json") for path in folder.glob(f"*/{name}")})


def _read(run: Path) -> Result | None:
    status = read_json(run / "status.json") if (run / "status.json").is_file() else {"state": "finished"}
    state = str(status.get("state"))
    if state == "finished" and (run / "metrics.json").is_file():
        return _finished(run.name, read_json(run / "metrics.json"), run / "metrics.json")
    if state == "finished" and run.name in PREPARATIONS:
        return None
    reason = status.get("reason") or ("it left no metrics.json" if state == "finished" else "no figures yet")
    components = components_of(run.name.partition("-")[0])
    return Result(run.name, "failed" if state == "finished" else state, str(reason), components=components)


def _finished(name: str, content: dict[str, Any], path: Path) -> Result:
    try:
        return Result(
            name,
            method=content["method"],
            components=content["components"],
            seed=content["seed"],
            data=content["data"],
            protocol=content["protocol"],
            metrics={k: float("nan") if v is None else float(v) for k, v in content["metrics"].items()},
            steps=content["steps"],
            seconds=content["seconds"],
            parameters=content["parameters"],
            origin={**content.get("versions", {}), "commit": content.get("commit")},
            pretrained=content.get("pretrained"),
            sheet=sheet if (sheet := path.with_name(SHEET)).is_file() else None,
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SagError(
            f"{path} is not what a test writes ({error!r}); delete its folder and run the row again"
        ) from error


def read_json(path: Path) -> dict[str, Any]:
    """What a run's JSON file holds.

    Raises:
        SagError: it cannot be read.
    """
    try:
        return dict(json.loads(path.read_text()))
    except (OSError, ValueError, TypeError) as error:
        raise SagError(f"{path} cannot be read ({error}); delete it and run the row again") from error


CONDITIONS: dict[str, Callable[[Result], Any]] = {
    "data set": lambda r: r.data.get("name"),
    "data fingerprint": lambda r: r.data.get("fingerprint"),
    "fps": lambda r: r.data.get("fps"),
    "N of motions": lambda r: r.protocol.get("motions"),
    "N of collision frames": lambda r: r.protocol.get("collision_frames"),
    "collision shape": lambda r: r.protocol.get("collision_shape"),
    "samples of each window": lambda r: r.protocol.get("samples"),
    "encoders": lambda r: r.protocol.get("encoders"),
    "skeleton": lambda r: r.protocol.get("skeleton"),
}
"""What must be equal for figures to be compared."""


def check_comparable(results: Sequence[Result]) -> None:
    """Refuses to lay figures side by side that were measured differently.

    Raises:
        SagError: the sentence names what differs, its values and their rows.
    """
    finished = [result for result in results if result.finished]
    differing = []
    for name, condition in CONDITIONS.items():
        rows: dict[str, list[str]] = {}
        for result in finished:
            rows.setdefault(str(condition(result)), []).append(result.label)
        if len(rows) > 1:
            differing.append(f"{name} ({'; '.join(f'{value} in {few(names)}' for value, names in rows.items())})")
    if differing:
        raise SagError(f"these rows cannot stand in one table, they differ in {', '.join(differing)}: run them alike")


def few(names: Sequence[str]) -> str:
    """All names where they are few, or the first and how many others."""
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} and {len(names) - 1} others"
