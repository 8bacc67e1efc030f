"""The trained run that comes with the package, for whoever has trained none; its model card lies beside it."""

from __future__ import annotations

import argparse
from pathlib import Path

NAME = "shipped"
"""What commands call it where they want a run's folder."""

FOLDER = Path(__file__).parent / "mdpc"
"""Where it lies: a folder as any run leaves it, with config.fit.yaml and checkpoints/last.ckpt."""


def run_path(text: str) -> Path:
    """The path that an argument names; `shipped`, where nothing else is called so, is the run that ships."""
    path = Path(text)
    return FOLDER if text == NAME and not path.exists() else path


def add_runs(parser: argparse.ArgumentParser) -> None:
    """Adds the argument `RUN ...`, into `runs`."""
    parser.add_argument(
        "runs", type=run_path, nargs="+", metavar="RUN", help="folder of a trained run or of a sweep, or shipped"
    )


def beside(place: Path, name: str) -> Path:
    """A new file beside what it is of; in the working folder where that is the run that ships."""
    return Path(name) if place == FOLDER else place / name
