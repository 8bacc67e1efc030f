"""`sag view SOURCE ...`: motions of runs and files in their scenes, as one HTML file for any browser."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.data.known import DATA_SETS
from sag.data.motion_file import MotionFile, read_motions
from sag.data.selection import chosen_windows, windows_at
from sag.errors import SagError
from sag.files import write_whole, writing_in
from sag.references import BESIDE, config_beside, data_of
from sag.runs import Run, read_runs
from sag.types import Batch
from sag.viewer import ShownWindow, page, shown_window
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
        "sources", type=Path, nargs="+", metavar="SOURCE",
        help="folder of a trained run or of a sweep, or a .npz of motions as `sag predict` writes it",
    )  # fmt: skip
    which = made.add_mutually_exclusive_group()
    which.add_argument("--windows", type=int, default=1, metavar="N", help="test windows, evenly spread (default: 1)")
    which.add_argument("--window", type=int, nargs="+", metavar="I", help="these test windows, by place in the data")
    made.add_argument(
        "--samples", type=int, default=5, metavar="K", help=f"motions of each, 1 to {MOST_MOTIONS} (default: 5)"
    )
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument(
        "--reference", metavar="DATA",
        help=f"data set of a file: {', '.join(DATA_SETS)}, or a YAML file with a key `data` (default: the runs', or "
        f"the {BESIDE[0]} beside the file)",
    )  # fmt: skip
    made.add_argument("--title", metavar="TEXT", help="of the page (default: the names of the rows)")
    made.add_argument("--out", type=Path, metavar="FILE.html", help="default: view.html beside the first source")
    made.add_argument("--cache-dir", type=Path, metavar="DIR", help="folder of the window caches, if it was moved")
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
    sources = _sources(asked)
    windows = [_window(sources, batch, asked) for batch in _batches(sources, asked)]
    names = ", ".join(row.name for row in windows[0].rows)
    text = page(windows, sources.data.skeleton, sources.data.fps, asked.title or f"{names}: motions in their scene")
    with writing_in(out, "give another file by --out"):
        write_whole(out, lambda file: file.write(text.encode()))
    said = ", ".join(window.name for window in windows[:4]) + (" and more" if len(windows) > 4 else "")
    print(f"{said}; rows: {names}")
    print(f"the page is in {out} ({len(text) / 1e6:.1f} MB): open it in a browser")
    return 0


@dataclass(frozen=True)
class Sources:
    """What is shown.

    Attributes:
        data: where all windows come from.
        runs: that are sampled.
        files: motions, by the name of their row.
    """

    data: MotionDataModule
    runs: list[Run]
    files: dict[str, MotionFile]

    @cached_property
    def rows(self) -> dict[str, dict[int, int]]:
        """For each file, its row of each window of the data set."""
        return {name: motions.by_window(self.data) for name, motions in self.files.items()}

    @property
    def places(self) -> list[int]:
        """Test windows, by place in the data set, that every file continues."""
        known = self.data.cache.rows("test").tolist()
        return [place for place in known if all(place in rows for rows in self.rows.values())]


def _sources(asked: argparse.Namespace) -> Sources:
    paths = [path for path in asked.sources if path.suffix == ".npz" or path.is_file()]
    folders = [path for path in asked.sources if path not in paths]
    if missing := [path for path in asked.sources if not path.exists()]:
        raise SagError(f"{missing[0]} does not exist; name the folder of a run or sweep, or a .npz of motions")
    files = {_name(path): read_motions(path, frames=None) for path in paths}
    runs = read_runs(folders, asked.cache_dir) if folders else []
    names = [run.name for run in runs] + [_name(path) for path in paths]
    if twice := [name for name in names if names.count(name) > 1]:
        raise SagError(f"two of the sources are called {twice[0]!r}, and rows are told apart by name: rename one")
    data = runs[0].data if runs and asked.reference is None else data_of(_reference(asked, paths), asked.cache_dir)
    for run in runs:
        if run.data.cache.fingerprint != data.cache.fingerprint:
            raise SagError(f"--reference {asked.reference} has not the windows that {run.name} was trained for")
    return Sources(data, runs, files)


def _name(path: Path) -> str:
    """What a file's row is called: by its folder where it has the usual name."""
    return path.resolve().parent.name if path.stem == "predictions" else path.stem


def _reference(asked: argparse.Namespace, paths: Sequence[Path]) -> str:
    """What tells the data set: the option, or a config beside a file."""
    if asked.reference is not None:
        return asked.reference
    for path in paths:
        if found := config_beside(path):
            return found
    raise SagError(f"{paths[0]} does not tell its data set; name it with --reference, such as rooms or a config")


def _batches(sources: Sources, asked: argparse.Namespace) -> list[Batch]:
    """The windows asked for, one by one, with their depth clouds where the data set has them."""
    whose = f"of {sources.data.name} that these sources have"
    chosen = chosen_windows(sources.places, asked.window, asked.windows, whose)
    batch = windows_at(sources.data, "test", chosen, with_cloud=True)
    return [batch[[place]] for place in range(len(batch))]


def _window(sources: Sources, batch: Batch, asked: argparse.Namespace) -> ShownWindow:
    place = int(batch.index[0])
    rows: dict[str, Tensor] = {run.name: _sampled(run, batch, asked) for run in sources.runs}
    for name, motions in sources.files.items():
        rows[name] = torch.from_numpy(motions.joints[sources.rows[name][place]][: asked.samples]).float()
    return shown_window(sources.data, batch, rows)


@torch.no_grad()
def _sampled(run: Run, batch: Batch, asked: argparse.Namespace) -> Float[Tensor, "k t j 3"]:
    """Motions of a window, the same whatever other windows are shown."""
    device = run.method.device
    generator = torch.Generator(device).manual_seed(asked.seed)
    drawn = run.method.samples(batch.to(device), asked.samples, generator)
    return torch.stack([motion.joints[0] for motion in drawn]).float().cpu()


def _out(path: Path | None, source: Path) -> Path:
    path = path or (source / "view.html" if source.is_dir() else source.with_suffix(".html"))
    if path.suffix != ".html" or path.is_dir():
        raise SagError(f"--out {path} must be a file that ends in .html")
    return path
