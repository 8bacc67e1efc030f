"""`sag data check PATH`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from sag.data.check.report import show
from sag.data.known import imported, recognised
from sag.data.options import module_from
from sag.data.sheet import check_sheet
from sag.errors import SagError
from sag.text import plain


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag data check`."""
    made = argparse.ArgumentParser(
        "sag data check",
        allow_abbrev=False,
        description="Says what a data set on disk holds, what its filters drop, whether its scale and units are right, "
        "and which files are broken; status 1 when something is.",
        epilog="Further options are those of training, such as --stride 5 or --data.init_args.limits.root_step 0.3.",
    )
    made.add_argument("path", type=Path, metavar="PATH", help="root of GTA-IM, PROX or your own data")
    made.add_argument("--config", type=Path, action="append", default=[], help="file with data.init_args; may repeat")
    made.add_argument("--pictures", default="24", metavar="N", help="frames decoded of each recording, or all")
    made.add_argument("--sheet", type=Path, metavar="FILE.png", help="draw windows with their motion to this file")
    made.add_argument("--count", type=int, default=12, help="windows on the sheet (default: 12)")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Checks a data set, prints what it found and draws a sheet where asked; 1 when something is broken.

    Raises:
        SagError: there is no data set, or an option is wrong.
    """
    asked, options = parser().parse_known_args(arguments)
    if asked.pictures != "all" and not asked.pictures.isdecimal():
        raise SagError(f"--pictures must be a number or all, found {asked.pictures!r}")
    if asked.sheet is not None:
        check_sheet("--sheet", asked.sheet, asked.count)
    known, root = recognised(asked.path)
    module, _ = module_from(known, root, options, asked.config)
    inspection = imported(known.inspector)(module, None if asked.pictures == "all" else int(asked.pictures))
    show(inspection.report, Console())
    if asked.sheet is not None:
        inspection.draw(asked.sheet, asked.count)
        print(f"the sheet is in {plain(str(asked.sheet))}")
    return 1 if inspection.report.lines("broken") else 0
