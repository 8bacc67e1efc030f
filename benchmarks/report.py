"""What a run of the benchmarks leaves: a table for people, a file for programs."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path

import torch
from rich.console import Console
from rich.table import Table

from benchmarks.claim import Claim
from benchmarks.peers import versions

COLUMNS = ("claim", "beside", "ours", "theirs", "found (rounds' range)", "asked", "met", "rounds")


def show(claims: Sequence[Claim], console: Console) -> None:
    """Prints one line for each claim, what else must be known of them, the versions and the machine."""
    table = Table(title="Claims, each measured in this run", show_lines=True)
    for name in COLUMNS:
        table.add_column(name, overflow="fold")
    for claim in claims:
        table.add_row(*_row(claim))
    console.print(table)
    for note in dict.fromkeys(f"{claim.what}: {claim.note}" for claim in claims if claim.note):
        console.print(f"- {note}", highlight=False)
    console.print("Times are process seconds of one thread and ratios medians of paired rounds, unless said otherwise.")
    console.print("A dash means that no bound is asked: the figure is told for whoever wants to know.")
    console.print(", ".join(f"{name} {number}" for name, number in versions().items()), highlight=False)
    console.print(", ".join(f"{name}: {value}" for name, value in machine().items()), highlight=False)


def write(claims: Sequence[Claim], path: Path) -> None:
    """Writes every figure with versions and machine as JSON."""
    found = {
        "claims": [{**_without_nan(asdict(claim)), "met": claim.met} for claim in claims],
        "versions": versions(),
        "machine": machine(),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(found, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def machine() -> dict[str, str]:
    """What the run stood on."""
    return {
        "cores": str(os.cpu_count()),
        "processor": _processor(),
        "vector instructions": torch.backends.cpu.get_cpu_capability(),
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
        "torch": torch.__version__,
    }


def _row(claim: Claim) -> tuple[str, ...]:
    spread = f" ({claim.spread[0]:.3g} - {claim.spread[1]:.3g})" if claim.spread else ""
    found = f"{claim.found:.3g}{claim.unit}{spread}"
    asked = "-" if claim.asked is None else f"{'>=' if claim.at_least else '<='} {claim.asked:g}"
    met = "-" if claim.asked is None else "[green]yes[/]" if claim.met else "[red]NO[/]"
    return claim.what, claim.peer, claim.ours, claim.theirs, found, asked, met, str(claim.rounds)


def _processor() -> str:
    """The processor's name; Linux keeps it in a file."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _without_nan(fields: dict[str, object]) -> dict[str, object]:
    """JSON has no word for a figure that could not be had."""
    return {name: None if isinstance(x, float) and not isfinite(x) else x for name, x in fields.items()}
