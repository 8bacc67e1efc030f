"""`sag view SOURCE ...`: motions of runs and files in their scenes, as one HTML file for any browser."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from sag.data.selection import chosen_windows
from sag.errors import SagError
from sag.files import write_whole, writing_in
from sag.options import add_cache_dir
from sag.references import BESIDE, add_reference
from sag.shipped import beside, run_path
from sag.sources import read_sources
from sag.viewer import page, shown_window
from sag.viewer.shown import MOST_MOTIONS

DESCRIPTION = """\
Shows motions in their scenes: one HTML file that any browser opens from the disk, without a network or a server.
A run is sampled now; the runs of a sweep, and several sources, are rows to switch between; a file of motions, as sag
predict writes it, is shown as it is."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag view`."""
    made = argparse.ArgumentParser(
        prog="sag view", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument(
        "sources", type=run_path, nargs="+", metavar="SOURCE",
        help="folder of a trained run or of a sweep, or a .npz of motions as `sag predict` writes it",
    )  # fmt: skip
    which = made.add_mutually_exclusive_group()
    which.add_argument("--windows", type=int, default=1, metavar="N", help="test windows, evenly spread (default: 1)")
    which.add_argument("--window", type=int, nargs="+", metavar="I", help="these test windows, by place in the data")
    made.add_argument(
        "--samples", type=int, default=5, metavar="K", help=f"motions of each, 1 to {MOST_MOTIONS} (default: 5)"
    )
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    add_reference(made, "data set of a file", f"the runs', or the {BESIDE[0]} beside the file")
    made.add_argument("--title", metavar="TEXT", help="of the page (default: the names of the rows)")
    made.add_argument("--out", type=Path, metavar="FILE.html", help="default: view.html beside the first source")
    add_cache_dir(made)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the page; returns the exit status 0.

    Raises:
        SagError: a source cannot be read, or does not fit the others; a window is unknown; a number is out of range.
    """
    asked = parser().parse_args(arguments)
    if not 1 <= asked.samples <= MOST_MOTIONS:
        raise SagError(f"--samples is {asked.samples}; a page tells 1 to {MOST_MOTIONS} motions of a row apart")
    out = _out(asked.out, asked.sources[0])
    sources = read_sources(asked.sources, asked.reference, asked.cache_dir)
    whose = f"of {sources.data.name} that these sources have"
    chosen = chosen_windows(sources.places, asked.window, asked.windows, whose)
    windows = [
        shown_window(sources.data, batch, sources.motions(batch, asked.samples, asked.seed))
        for batch in sources.batches(chosen)
    ]
    names = ", ".join(row.name for row in windows[0].rows)
    text = page(windows, sources.data.skeleton, sources.data.fps, asked.title or f"{names}: motions in their scene")
    with writing_in(out, "give another file by --out"):
        write_whole(out, lambda file: file.write(text.encode()))
    said = ", ".join(window.name for window in windows[:4]) + (" and more" if len(windows) > 4 else "")
    print(f"{said}; rows: {names}")
    print(f"the page is in {out} ({len(text) / 1e6:.1f} MB): open it in a browser")
    return 0


def _out(path: Path | None, source: Path) -> Path:
    path = path or (beside(source, "view.html") if source.is_dir() else source.with_suffix(".html"))
    if path.suffix != ".html" or path.is_dir():
        raise SagError(f"--out {path} must be a file that ends in .html")
    return path
