"""`sag sample [RUN] ...`: draws motions and writes them in the formats that are asked for."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch
import yaml

from sag.data.motion_file import MotionFile, write_motions
from sag.errors import SagError
from sag.exporting import main as export
from sag.exporting.formats import FORMATS
from sag.files import write_whole, writing_in
from sag.options import add_cache_dir
from sag.references import BESIDE, add_reference
from sag.runs import read_run
from sag.sample.drawing import LEAST_FRAMES, drawn
from sag.sample.photo import add_photo_options, check_photo_options, photo_source
from sag.sample.source import WindowSource, window_source
from sag.shipped import FOLDER, run_path
from sag.text import plain
from sag.view import main as view
from sag.viewer.shown import MOST_MOTIONS

DESCRIPTION = """\
Draws motions of any length from a trained run: from your own photograph (--image), or from test windows of a data set.
Writes DIR/motions.npz, as sag predict does, and beside it what the other commands need to know of the scene, so that
sag view, sag export and sag figure go on from there; --to makes their files at once."""

MADE = ("html", *FORMATS)
"""What `--to` may name."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag sample`."""
    made = argparse.ArgumentParser(
        prog="sag sample", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument(
        "run", type=run_path, nargs="?", default=FOLDER, metavar="RUN_OR_CHECKPOINT",
        help="folder of a trained run, or a .ckpt file in it (default: the run that ships with sag)",
    )  # fmt: skip
    made.add_argument("--samples", type=int, default=5, metavar="K", help="motions of each window (default: 5)")
    made.add_argument(
        "--frames", type=int, default=65, metavar="N", help="of each, the given one included (default: 65)"
    )
    made.add_argument("--overlap", type=int, default=8, metavar="O", help="frames shared beyond 65, as in sag extend")
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of what is drawn (default: 0)")
    made.add_argument("--output", type=Path, default=Path("samples"), metavar="DIR", help="folder (default: samples)")
    made.add_argument(
        "--to", action="append", default=[], choices=MADE, metavar="FORMAT",
        help=f"also make {', '.join(MADE)}; may repeat",
    )  # fmt: skip
    made.add_argument("--orbit", action="store_true", help="mp4, gif: also a view from a camera that swings around")
    which = made.add_argument_group("from a data set").add_mutually_exclusive_group()
    which.add_argument("--windows", type=int, metavar="N", help="test windows, evenly spread (default: 1)")
    which.add_argument("--window", type=int, nargs="+", metavar="I", help="these test windows, by place in the data")
    add_reference(made, "another data set than the run's")
    add_cache_dir(made)
    add_photo_options(made.add_argument_group("from a photograph"))
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws and writes; returns the exit status 0.

    Raises:
        SagError: the run, the photograph or an option is refused; the sentence names it.
    """
    asked = parser().parse_args(arguments)
    _check(asked)
    place = asked.run
    began = time.perf_counter()
    run = read_run(place, None if asked.image else asked.cache_dir)
    source = photo_source(run, place, asked) if asked.image else window_source(run, place, asked)
    print(f"{plain(run.name)}: loaded in {time.perf_counter() - began:.1f} s; {source.about}")
    began = time.perf_counter()
    motions = torch.stack([drawn(run.method, batch, asked) for batch in source.batches]).numpy()
    seconds, count = time.perf_counter() - began, motions.shape[0] * motions.shape[1]
    path = asked.output / "motions.npz"
    with writing_in(asked.output, "give another folder by --output"):
        write_motions(path, MotionFile(path, motions, source.index, source.fps, run.method.skeleton.name))
        _write_reference(asked.output / BESIDE[0], source.reference)
    each = f"drawn in {seconds / count:.2f} s each" if count > 1 else f"drawn in {seconds:.2f} s"
    print(f"{count} motion{'s' * (count > 1)} of {asked.frames} frames, {each}, are in {plain(str(path))}")
    _make(path, source, asked)
    return 0


def _check(asked: argparse.Namespace) -> None:
    if asked.samples < 1:
        raise SagError(f"--samples is {asked.samples}; at least one motion is needed")
    if asked.frames < LEAST_FRAMES:
        raise SagError(f"--frames is {asked.frames}; a motion has at least {LEAST_FRAMES}, the given one included")
    if asked.orbit and not {"mp4", "gif"} & set(asked.to):
        raise SagError("--orbit is for films; add --to mp4 or --to gif")
    if asked.output.is_file():
        raise SagError(f"--output {asked.output} is a file; give a folder")
    if "html" in asked.to and asked.samples > MOST_MOTIONS:
        raise SagError(f"--samples is {asked.samples}; a page of --to html tells {MOST_MOTIONS} motions apart at most")
    check_photo_options(asked)


def _write_reference(path: Path, reference: dict[str, Any]) -> None:
    """Tells other commands of the data set that the windows are of."""
    text = yaml.safe_dump({"data": reference}, sort_keys=False)
    write_whole(path, lambda file: file.write(text.encode()))


def _make(path: Path, source: WindowSource, asked: argparse.Namespace) -> None:
    """What `--to` asks for, by the commands that make it of any file of motions."""
    folder = ["--output", str(asked.output)]
    for form in dict.fromkeys(asked.to):
        if form == "html":
            page = ["--window", *(str(window) for window in source.index), "--samples", str(asked.samples)]
            view([str(path), *page, "--out", str(path.with_suffix(".html"))])
            continue
        options = ["--all", *([] if form == "bvh" else ["--together"])]
        options += ["--scene"] if form == "glb" and source.has_depth else []
        export([str(path), "--to", form, *folder, *options])
        if asked.orbit and form in ("mp4", "gif"):
            export([str(path), "--to", form, *folder, *options, "--orbit"])
