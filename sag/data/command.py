"""`sag data`: builds the synthetic rooms and shows them, checks and prepares other data sets."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from sag.data.check.command import main as check
from sag.data.layouts.command import add_options, write
from sag.data.prepare import main as prepare
from sag.data.rooms import Recipe, RoomsDataModule
from sag.data.sheet import check_sheet
from sag.errors import SagError

ROOMS = "Builds the embedded synthetic rooms and says what they hold; draws them, or writes them in another layout."

OF_THEIR_OWN: dict[str, tuple[Callable[[Sequence[str]], int], str]] = {
    "check": (check, "whether GTA-IM, PROX or your own data are whole and in the right units"),
    "prepare": (prepare, "convert GTA-IM, PROX or your own data into the cache that training reads"),
}
"""Commands on other data sets, which take their arguments themselves."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag data`."""
    made = argparse.ArgumentParser(prog="sag data", description="Builds and shows data sets.")
    sets = made.add_subparsers(dest="name", required=True, metavar="DATASET")
    rooms = sets.add_parser("rooms", help="the embedded synthetic rooms", description=ROOMS)
    rooms.add_argument("--cache_dir", type=Path, default=Path("data"), metavar="DIR", help="default: data")
    rooms.add_argument("--image_size", type=int, nargs=2, default=Recipe.image_size, metavar=("ROWS", "COLUMNS"))
    rooms.add_argument("--seed", type=int, default=0, help="of all that is drawn (default: 0)")
    rooms.add_argument("--workers", type=int, default=2, help="processes that build (default: 2)")
    rooms.add_argument("--preview", type=Path, metavar="FILE.png", help="draw windows with their motion to this file")
    rooms.add_argument("--count", type=int, default=12, help="windows on the preview (default: 12)")
    add_options(rooms)
    for name, (_, about) in OF_THEIR_OWN.items():
        sets.add_parser(name, help=about, add_help=False)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Builds what is missing, says what is there, and draws a sheet or writes another layout where asked.

    Raises:
        SagError: what is asked for cannot be done.
    """
    arguments = sys.argv[2:] if arguments is None else arguments
    if arguments and arguments[0] in OF_THEIR_OWN:
        return OF_THEIR_OWN[arguments[0]][0](arguments[1:])
    asked = parser().parse_args(arguments)
    if asked.preview is not None:
        check_sheet("--preview", asked.preview, asked.count)
    if asked.layout is not None:
        write(asked)
        return 0
    if asked.folder is not None:
        raise SagError(f"{asked.folder}: a folder is written to with --layout only, such as --layout gta-im")
    module = RoomsDataModule(
        cache_dir=asked.cache_dir, image_size=tuple(asked.image_size), seed=asked.seed, workers=asked.workers
    )
    cache = module.cache
    counts = ", ".join(f"{count} {split}" for split, count in module.describe()["windows"].items())
    dropped = ", ".join(f"{count} {reason}" for reason, count in cache.index["dropped"].items()) or "none"
    print(f"{cache.folder}: {counts} windows at {module.fps:g} frames a second; dropped: {dropped}")
    if asked.preview is not None:
        from sag.data.rooms.preview import sheet

        sheet(cache, asked.preview, asked.count)
        print(f"the sheet is in {asked.preview}")
    return 0
