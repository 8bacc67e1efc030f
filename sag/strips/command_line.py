"""`sag figure strips RUN ...` and `sag figure sheets RUN ...`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import matplotlib

from sag.data.selection import chosen_windows, windows_at
from sag.errors import SagError
from sag.files import write_whole, writing_in
from sag.film.samples import SHEET, SHEET_WINDOWS, sampled, spread_windows, stages_of, write_sheet
from sag.report.plot import NO_METADATA, STYLE
from sag.runs import Run, read_runs, run_places
from sag.strips.figure import Panel, strips_of
from sag.text import plain

FORMATS = ("png", "svg", "pdf")

DESCRIPTION = """\
strips: poses of a motion in one picture, from dark (given) to bright (last), as in the paper's Figures 1, 4 and 8: a
line of pictures for each scene, a column for each run; with one run, several motions of it side by side.
sheets: a small contact sheet of each run, samples.png in its folder, which sag report embeds; tests write it too."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag figure`."""
    made = argparse.ArgumentParser(
        prog="sag figure", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("kind", choices=("strips", "sheets"))
    made.add_argument("runs", type=Path, nargs="+", metavar="RUN", help="folder of a trained run, or of a sweep")
    which = made.add_mutually_exclusive_group()
    which.add_argument("--windows", type=int, metavar="N", help="strips: scenes, evenly spread (default: 3)")
    which.add_argument("--window", type=int, nargs="+", metavar="I", help="strips: these, by place in the data")
    made.add_argument("--samples", type=int, metavar="K", help="strips: motions (default: 1, or 3 of one run)")
    made.add_argument("--together", action="store_true", help="strips: all motions in one picture, as in Figure 1")
    made.add_argument("--poses", type=int, default=6, metavar="P", help="strips: of each motion (default: 6)")
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument(
        "--out", type=Path, metavar="FILE", help=f"strips: in .{', .'.join(FORMATS)} (default: strips.png)"
    )
    made.add_argument("--cache-dir", type=Path, metavar="DIR", help="folder of the window caches, if it was moved")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws; returns the exit status 0.

    Raises:
        SagError: a folder holds no trained run, runs cannot be compared, or a number is out of range.
    """
    asked = parser().parse_args(arguments)
    if asked.kind == "sheets":
        return _sheets(asked)
    out = asked.out or Path("strips.png")
    if out.suffix.lower().removeprefix(".") not in FORMATS or out.is_dir():
        raise SagError(f"--out {out} must be a file that ends in .{', .'.join(FORMATS)}")
    if asked.poses < 2 or (asked.samples is not None and asked.samples < 1):
        raise SagError("--poses must be at least 2 and --samples at least 1")
    runs = sorted(read_runs(asked.runs, asked.cache_dir), key=_letters)
    data = runs[0].data
    count = 3 if asked.windows is None else asked.windows
    places = chosen_windows(data.cache.rows("test").tolist(), asked.window, count, f"of {data.name}")
    panels = [_panels(runs, place, asked) for place in places]
    with writing_in(out, "give another file by --out"), matplotlib.rc_context(STYLE):
        canvas = strips_of(panels, asked.poses)
        rest = {"metadata": NO_METADATA} if out.suffix == ".svg" else {}
        write_whole(out, lambda file: canvas.savefig(file, format=out.suffix[1:].lower(), dpi=200, **rest))
    scenes = f"{len(panels)} scene{'s' * (len(panels) > 1)}"
    print(f"{scenes}, {', '.join(dict.fromkeys(panel.title for panel in panels[0]))}: {plain(str(out))}")
    return 0


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
        panels += [Panel(title if len(parts) == 1 else f"{title} {n + 1}", stages_of(run.data, batch, part)[0])
                   for n, part in enumerate(parts)]  # fmt: skip
    return panels


def _sheets(asked: argparse.Namespace) -> int:
    """Writes the contact sheet of every run into its folder."""
    for folder in [place for given in asked.runs for place in run_places(given)]:
        (run,) = read_runs([folder], asked.cache_dir)
        batch = windows_at(run.data, "test", spread_windows(run.data, "test", SHEET_WINDOWS))
        with writing_in(folder, "it must be a folder that can be written"):
            write_sheet(folder / SHEET, stages_of(run.data, batch, sampled(run.method, batch, 1, asked.seed)))
        print(f"{run.name}: {plain(str(folder / SHEET))}")
    return 0
