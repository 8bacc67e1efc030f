"""The report in Weights & Biases: its rows as a table, its plots as pictures; offline unless told otherwise."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

import wandb

PROJECT = "sag"
TABLES = ("table", "statistics")
"""CSV files of a report that become tables, those that are there."""

Cell = str | float | None


def track(out: Path, title: str) -> str:
    """Logs a report's files as one run of W&B, beside them where it is offline; returns where it is.

    Args:
        out: folder of the report, written already.
        title: of the report, and name of the run.
    """
    mode: Literal["online", "offline"] = "online" if os.environ.get("WANDB_MODE") == "online" else "offline"
    settings = wandb.Settings(silent=True, x_disable_stats=True, console="off")
    run = wandb.init(project=PROJECT, name=title, job_type="report", dir=out, mode=mode, settings=settings)
    try:
        tables = {name: _table(out / f"{name}.csv") for name in TABLES if (out / f"{name}.csv").is_file()}
        plots = {path.stem: wandb.Image(str(path)) for path in sorted(out.glob("*.png"))}
        run.log({**tables, **plots})
        return str(run.url if mode == "online" else Path(run.dir).parent)
    finally:
        run.finish()


def _table(path: Path) -> wandb.Table:
    """A CSV file with its numbers as numbers, so that W&B sorts and plots by them; empty cells are None."""
    header, *rows = csv.reader(io.StringIO(path.read_text(encoding="utf-8")))
    columns = [_typed(values) for values in zip(*rows)]
    return wandb.Table(columns=[*header], data=[list(row) for row in zip(*columns)], allow_mixed_types=True)


def _typed(values: Sequence[str]) -> list[Cell]:
    """A column as numbers where every value that is there is one, as text where it is not."""
    with suppress(ValueError):
        return [float(value) if value else None for value in values]
    return [value or None for value in values]
