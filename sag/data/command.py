"""`sag data rooms`: builds the synthetic rooms and shows them."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from sag.data.rooms import Recipe, RoomsDataModule


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag data`."""
    made = argparse.ArgumentParser(prog="sag data", description="Builds and shows data sets.")
    sets = made.add_subparsers(dest="name", required=True, metavar="DATASET")
    rooms = sets.add_parser("rooms", help="the embedded synthetic rooms", description=RoomsDataModule.__doc__)
    rooms.add_argument("--cache_dir", type=Path, default=Path("data"), metavar="DIR", help="default: data")
    rooms.add_argument("--image_size", type=int, nargs=2, default=Recipe.image_size, metavar=("ROWS", "COLUMNS"))
    rooms.add_argument("--seed", type=int, default=0, help="of all that is drawn (default: 0)")
    rooms.add_argument("--workers", type=int, default=2, help="processes that build (default: 2)")
    rooms.add_argument("--preview", type=Path, metavar="FILE.png", help="draw windows with their motion to this file")
    rooms.add_argument("--count", type=int, default=12, help="windows on the preview (default: 12)")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Builds what is missing, says what is there, and draws a sheet where asked."""
    asked = parser().parse_args(arguments)
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
