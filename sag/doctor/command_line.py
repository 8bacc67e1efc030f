"""`sag doctor`: versions, devices, folders and services, and what to do about each."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console

from sag.data.check.report import Report, Section, show
from sag.doctor.folders import RUNS, clone_line, folder_line, needed_for_data
from sag.doctor.machine import device_lines, memory_line
from sag.doctor.packages import modules, package_lines, required
from sag.doctor.probed import probed
from sag.doctor.services import program_lines, slurm_line, wandb_line

DESCRIPTION = """\
Looks at this machine before hours are spent on it: versions, devices, folders, W&B, SLURM, and programs that something
is better with. Each line that is not ok says what to do. Exit status 1 when something would stop make ablation."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag doctor`."""
    made = argparse.ArgumentParser("sag doctor", allow_abbrev=False, description=DESCRIPTION)
    made.add_argument("--data", type=Path, default=Path("data"), metavar="DIR", help="folder of data (default: data)")
    made.add_argument("--runs", type=Path, default=Path("runs"), metavar="DIR", help="folder of runs (default: runs)")
    made.add_argument("--json", action="store_true", help="print JSON, for programs")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints what was found; 1 when something would stop `make ablation`."""
    asked = parser().parse_args(arguments)
    console = Console()
    if asked.json:
        report = examined(asked.data, asked.runs)
        print(json.dumps(as_json(report), indent=1))
    else:
        with console.status("importing packages and trying devices ..."):
            report = examined(asked.data, asked.runs)
        show(report, console)
    return 1 if report.lines("broken") else 0


def examined(data: Path, runs: Path) -> Report:
    """All that there is to be said of this machine.

    Args:
        data: folder of data.
        runs: folder of runs.
    """
    asked = required()
    tried = probed(modules(asked))
    folders = (
        clone_line(),
        folder_line("data", data, needed_for_data(data), "choose another by --data.init_args.cache_dir"),
        folder_line("runs", runs, RUNS, "choose another: make ablation RUNS=DIR"),
    )
    sections = (
        Section("Packages", tuple(package_lines(asked, tried))),
        Section("Machine", (memory_line(), *device_lines(tried))),
        Section("Folders", folders),
        Section("Around it", (wandb_line(), slurm_line(), *program_lines())),
    )
    return Report("Is this machine ready for make ablation?", sections, good="yes")


def as_json(report: Report) -> dict[str, Any]:
    """The report for programs: `stops` names what would stop `make ablation`."""
    sections = {section.title: [asdict(line) for line in section.lines] for section in report.sections}
    return {"stops": [line.name for line in report.lines("broken")], "sections": sections}
