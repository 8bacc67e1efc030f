"""`sag figure strips RUN ...`, `sag figure sheets RUN ...` and `sag figure speeds RUN ...`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import matplotlib
import torch

from sag.data.selection import chosen_windows, windows_at
from sag.errors import SagError
from sag.figures.speeds import histogram_of, speeds, summary
from sag.figures.strips import Panel, strips_of
from sag.files import write_whole, writing_in
from sag.film.samples import SHEET, sampled, stages_of, write_samples
from sag.options import add_cache_dir
from sag.report.plot import NO_METADATA, STYLE
from sag.runs import Run, read_runs, run_places
from sag.shipped import add_runs, beside
from sag.text import plain

FORMATS = ("png", "svg", "pdf")

DESCRIPTION = """\
strips: poses of a motion in one picture, from dark (given) to bright (last), as in the paper's Figures 1, 4 and 8: a
line of pictures for each scene, a column for each run; with one run, several motions of it side by side.
sheets: a small contact sheet of each run, samples.png in its folder, which sag report embeds; tests write it too.
speeds: how fast people move, a histogram for each run beside the recorded motions, and how many stand."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag figure`."""
    made = argparse.ArgumentParser(
        prog="sag figure", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("kind", choices=("strips", "sheets", "speeds"))
    add_runs(made)
    which = made.add_mutually_exclusive_group()
    which.add_argument(
        "--windows", type=int, metavar="N", help="scenes, evenly spread (default: 3 in strips, all in speeds)"
    )
    which.add_argument("--window", type=int, nargs="+", metavar="I", help="these scenes, by place in the data")
    made.add_argument(
        "--samples", type=int, metavar="K", help="motions of each (default: 1, or 3 in strips of one run)"
    )
    made.add_argument("--together", action="store_true", help="strips: all motions in one picture, as in Figure 1")
    made.add_argument("--poses", type=int, default=6, metavar="P", help="strips: of each motion (default: 6)")
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument(
        "--out", type=Path, metavar="FILE", help=f"in .{', .'.join(FORMATS)} (default: strips.png, speeds.png)"
    )
    add_cache_dir(made)
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws; returns the exit status 0.

    Raises:
        SagError: a folder holds no trained run, runs cannot be compared, or a number is out of range.
    """
    asked = parser().parse_args(arguments)
    if asked.kind == "sheets":
        return _sheets(asked)
    out = asked.out or Path(f"{asked.kind}.png")
    if out.suffix.lower().removeprefix(".") not in FORMATS or out.is_dir():
        raise SagError(f"--out {out} must be a file that ends in .{', .'.join(FORMATS)}")
    if asked.poses < 2 or (asked.samples is not None and asked.samples < 1):
        raise SagError("--poses must be at least 2 and --samples at least 1")
    runs = sorted(read_runs(asked.runs, asked.cache_dir), key=_letters)
    known = runs[0].data.cache.rows("test").tolist()
    count = asked.windows if asked.windows is not None else {"strips": 3, "speeds": len(known)}[asked.kind]
    places = chosen_windows(known, asked.window, count, f"of {runs[0].data.name}")
    with writing_in(out, "give another file by --out"), matplotlib.rc_context(STYLE):
        {"strips": _strips, "speeds": _speeds}[asked.kind](runs, places, asked, out)
    return 0


def _strips(runs: Sequence[Run], places: Sequence[int], asked: argparse.Namespace, out: Path) -> None:
    """Writes the strips and says what they show."""
    panels = [_panels(runs, place, asked) for place in places]
    _write(strips_of(panels, asked.poses), out)
    scenes = f"{len(panels)} scene{'s' * (len(panels) > 1)}"
    print(f"{scenes}, {', '.join(dict.fromkeys(panel.title for panel in panels[0]))}: {plain(str(out))}")


def _speeds(runs: Sequence[Run], places: Sequence[int], asked: argparse.Namespace, out: Path) -> None:
    """Writes the histograms and prints what they come to."""
    data, size = runs[0].data, runs[0].data.eval_batch_size
    batches = [windows_at(data, "test", places[first : first + size]) for first in range(0, len(places), size)]
    truth = speeds(torch.cat([batch.motion.roots for batch in batches]), data.fps)
    rows = {}
    for run in runs:
        drawn = [sampled(run.method, batch, asked.samples or 1, asked.seed + n) for n, batch in enumerate(batches)]
        roots = torch.cat(drawn).flatten(0, 1)[:, :, data.skeleton.root_index]
        rows[run.name.replace("_", " ")] = speeds(roots, data.fps)
    _write(histogram_of(rows, truth), out)
    print(summary({**rows, "recorded": truth}, truth))
    print(plain(str(out)))


def _write(canvas: Any, out: Path) -> None:
    rest = {"metadata": NO_METADATA} if out.suffix == ".svg" else {}
    write_whole(out, lambda file: canvas.savefig(file, format=out.suffix[1:].lower(), dpi=200, **rest))


def _letters(run: Run) -> int:
    """Components that are on; of a method that has none, more than any."""
    components = getattr(run.method, "components", None)
    return 99 if components is None else sum(asdict(components).values())


def _panels(runs: Sequence[Run], place: int, asked: argparse.Namespace) -> list[Panel]:
    """The pictures of one scene: of every run, or of every motion of the only one."""
    samples = asked.samples or (3 if len(runs) == 1 else 1)
    panels = []
    for run in runs:
        batch = windows_at(run.data, "test", [place])
        motions = sampled(run.method, batch, samples, asked.seed)
        parts = [motions] if asked.together or len(runs) > 1 else list(motions.split(1, dim=1))
        title = run.name.replace("_", " ")
        for n, part in enumerate(parts, start=1):
            (stage,) = stages_of(run.data, batch, part, with_surface=True)
            panels.append(Panel(title if len(parts) == 1 else f"{title} {n}", stage))
    return panels


def _sheets(asked: argparse.Namespace) -> int:
    """Writes the contact sheet of every run into its folder."""
    for folder in [place for given in asked.runs for place in run_places(given)]:
        (run,) = read_runs([folder], asked.cache_dir)
        path = beside(folder, SHEET)
        with writing_in(path.parent, "it must be a folder that can be written"):
            write_samples(path, run.method, run.data, asked.seed)
        print(f"{run.name}: {plain(str(path))}")
    return 0
