"""Rows: what a sweep runs, each with a name that is a folder."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

from sag.errors import SagError
from sag.files import sha256_of
from sag.letters import LETTERS, components_of, row_name
from sag.sweep.command import Additions, command_hash, preparation_command, row_command, written
from sag.sweep.definition import Point, Sweep
from sag.sweep.trials import Trial

COMPONENTS = "components."
ENCODERS = "configs/methods/erd.yaml"
GROUND_TRUTH = "configs/methods/ground_truth.yaml"
BLIND = "configs/methods/blind.yaml"
PRETRAINED = "pretrained"
ENCODERS_ROW = "encoders"
GROUND_TRUTH_ROW = "ground_truth"


@dataclass(frozen=True)
class Row:
    """One command of a sweep, run in its own process and folder.

    Attributes:
        name: name of its folder.
        command: what is run, without the folder it writes to.
        fingerprint: of the command and its configs: an unchanged row is not run twice.
        measured: whether it must leave a `metrics.json`.
        alone: whether everything after it waits for it, and stops when it fails.
        typical: whether it takes about as long as the others: those of the grid do.
        trial: number of its trial in a search.
        point: values that the search has drawn for it.
    """

    name: str
    command: tuple[str, ...]
    fingerprint: str
    measured: bool = True
    alone: bool = False
    typical: bool = True
    trial: int | None = None
    point: Point | None = None


def plan(sweep: Sweep, additions: Additions, seeds: int | None = None, trials: Sequence[Trial] = ()) -> list[Row]:
    """Everything a sweep runs, in order: encoders, ground truth, then the grid and the blind row of an ablation.

    A search has its trials in place of the last two, those that are known.
    A command without the subcommand `run` is not this program's, and is run as it stands.

    Raises:
        SagError: two rows have one name, a component is unknown, or a config file is missing.
    """
    _check_components(sweep)
    prepared = _preparations(sweep, additions) if "run" in sweep.command else []
    after = prepared[0].fingerprint if prepared else ""
    if sweep.method == "grid":
        rows = prepared + _grid_rows(sweep, additions, seeds, after)
    else:
        rows = prepared + [row for trial in trials for row in _trial_rows(sweep, trial, additions, seeds, after)]
    twice = [name for name, count in Counter(row.name for row in rows).items() if count > 1]
    if twice:
        raise SagError(f"{sweep.path}: two rows would share the folder {twice[0]!r}; rename one or vary another key")
    return rows


def _grid_rows(sweep: Sweep, additions: Additions, seeds: int | None, after: str) -> list[Row]:
    grid = [(name_of(point, sweep.varied), point) for point in _seeded(sweep.points(), seeds)]
    blind = _blind(grid) if "run" in sweep.command else {}
    rows = [_row(sweep, name, point, additions, after) for name, point in grid]
    return rows + [_row(sweep, name, point, _blinding(additions), after) for name, point in blind.items()]


def _trial_rows(sweep: Sweep, trial: Trial, additions: Additions, seeds: int | None, after: str) -> list[Row]:
    """The rows of a trial, one for each seed; their names begin with its number, since points may look alike."""
    rows = []
    for point in _seeded([trial.point], seeds):
        name = f"t{trial.number:03d}-{name_of(point, sweep.varied)}"
        rows.append(replace(_row(sweep, name, point, additions, after), trial=trial.number, point=trial.point))
    return rows


def _preparations(sweep: Sweep, additions: Additions) -> list[Row]:
    """The encoders of Motion FID (their run also builds the data), then the ground truth that they measure."""
    overlay = (f"--config={ENCODERS}", "--model.init_args.retrain=false")
    encoders = tuple(preparation_command(sweep, "fit", overlay, additions))
    fingerprint = command_hash(encoders)
    truth = tuple(preparation_command(sweep, "test", (f"--config={GROUND_TRUTH}",), additions))
    return [
        Row(ENCODERS_ROW, encoders, fingerprint, measured=False, alone=True, typical=False),
        Row(GROUND_TRUTH_ROW, truth, command_hash(truth, fingerprint), typical=False),
    ]


def _row(sweep: Sweep, name: str, point: Point, additions: Additions, after: str) -> Row:
    if additions.pretrained is not None:
        start = _start(additions.pretrained, name)
        point, after = {**point, PRETRAINED: str(start)}, after + sha256_of(start)
    command = tuple(row_command(sweep, point, additions))
    return Row(name, command, command_hash(command, after))


def _start(folder: Path, name: str) -> Path:
    """The checkpoint in which a row starts, of the row of the same name in another sweep."""
    path = folder / name / "checkpoints" / "last.ckpt"
    if not path.is_file():
        raise SagError(f"--pretrained {folder}: {path} is missing; run the same sweep to {folder} first, on other data")
    return path


def _blind(grid: Sequence[tuple[str, Point]]) -> dict[str, Point]:
    """Blind rows by name, where components vary: one for each choice of all else, so that each has its zero."""
    rows = [(*name.partition("-"), point) for name, point in grid if components_of(name.partition("-")[0])]
    if len({letters for letters, *_ in rows}) < 2:
        return {}
    return {f"blind{dash}{rest}": _without_components(point, letters) for letters, dash, rest, point in rows}


def _without_components(point: Point, letters: str) -> Point:
    """A point without what chooses its components: keys of their own, or the config of its row."""
    of_row = {name for name, value in point.items() if name == "config" and PurePath(str(value)).stem == letters}
    return {n: v for n, v in point.items() if not n.startswith(COMPONENTS) and n not in of_row}


def _blinding(additions: Additions) -> Additions:
    """The additions of a call with the blind row's config, whose components no setting changes."""
    settings = tuple(setting for setting in additions.settings if not setting.startswith(COMPONENTS))
    return replace(additions, configs=(*additions.configs, BLIND), settings=settings)


def _seeded(points: list[Point], seeds: int | None) -> list[Point]:
    if seeds is None:
        return points
    return [{**point, "seed_everything": seed} for point in points for seed in range(seeds)]


def name_of(point: Point, varied: Sequence[str]) -> str:
    """The name of a row: letters for components, the stem of a config, `key=value` for the rest, `-s1` for seed 1."""
    rest = {name: value for name, value in point.items() if not name.startswith(COMPONENTS)}
    parts = []
    if len(rest) < len(point):
        parts.append(row_name({n.removeprefix(COMPONENTS): bool(v) for n, v in point.items() if n not in rest}))
    if "config" in rest:
        parts.append(PurePath(str(rest.pop("config"))).stem)
    seed = rest.pop("seed_everything", None)
    short = [name for name in rest if name in varied]
    parts += [f"{_short_key(name, short)}={written(rest[name])}" for name in short]
    parts += [] if seed is None else [f"s{seed}"]
    return re.sub(r"[^\w.=+-]+", "_", "-".join(parts)) or "row"


def _short_key(name: str, names: Sequence[str]) -> str:
    """The last part of a dotted key, or all of it where another key ends alike."""
    last = name.rpartition(".")[2]
    return last if [n.rpartition(".")[2] for n in names].count(last) == 1 else name


def _check_components(sweep: Sweep) -> None:
    """Refuses a component that does not exist before an hour is spent on it."""
    for name in sweep.parameters:
        component = name.removeprefix(COMPONENTS)
        if component != name and component not in LETTERS:
            raise SagError(f"{sweep.path}: unknown component {component!r}; known are {', '.join(LETTERS)}")
