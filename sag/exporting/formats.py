"""The formats of `sag export`, and how each is written."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from sag.errors import SagError
from sag.export import BvhForm, write_bvh, write_glb
from sag.export.bvh import EXACT
from sag.export.source import Source
from sag.film import orbit_frames, overlay_frames, stage_of, write_film
from sag.film.encoding import every_frame
from sag.film.rrd import write_rrd
from sag.film.stage import Stage
from sag.text import plain

COLUMNS, GIF_COLUMNS = 864, 480
"""Of films, at most; GIFs grow large."""


@dataclass(frozen=True)
class Written:
    """What is in a file.

    Attributes:
        about: for the terminal.
        form: of a BVH file.
    """

    about: str
    form: BvhForm | None = None


Write = Callable[[Path, Source, int, Sequence[int], argparse.Namespace], Written]
"""Writes samples of a window to a path; several only where the format holds several."""


def _bvh(path: Path, source: Source, window: int, samples: Sequence[int], asked: argparse.Namespace) -> Written:
    joints = source.joints(window, samples[0])
    form = write_bvh(path, joints, source.skeleton, source.fps, asked.unit, asked.rigid or None)
    if form.rigid:
        return Written(f"rotations only: {lost(form.largest, form.mean)}, in {asked.unit}", form)
    return Written(f"rotations, and the place of every joint since bones stretch: exact, in {asked.unit}", form)


def _glb(path: Path, source: Source, window: int, samples: Sequence[int], asked: argparse.Namespace) -> Written:
    surface = source.surface(window) if asked.scene else None
    motions = [source.joints(window, sample) for sample in samples]
    write_glb(path, motions, source.skeleton, source.fps, surface, source.view(window))
    around = "" if surface is None else f" in a scene of {len(surface.triangles):,} triangles"
    return Written(("a body" if len(motions) == 1 else f"{len(motions)} bodies") + around + ", in m")


def _film(path: Path, source: Source, window: int, samples: Sequence[int], asked: argparse.Namespace) -> Written:
    stage, every = _stage(source, window, samples), every_frame(path, source.fps)
    columns, count = GIF_COLUMNS if path.suffix.lower() == ".gif" else COLUMNS, len(range(0, stage.frames, every))
    size = columns * 9 // 16 // 2 * 2, columns
    frames = orbit_frames(stage, size, every) if asked.orbit else overlay_frames(stage, columns, every)
    console = Console()
    shown = track(frames, plain(path.name), count, console=console, transient=True, disable=not console.is_terminal)
    write_film(path, shown, source.fps / every, np.stack([stage.colour(number) for number in range(len(samples))]))
    seen = "from an eye that swings around them" if asked.orbit else "of the picture with the motion in it"
    return Written(f"{count} frames {seen}, {source.fps / every:g} a second")


def _rrd(path: Path, source: Source, window: int, samples: Sequence[int], asked: argparse.Namespace) -> Written:
    stage = _stage(source, window, samples)
    write_rrd(path, stage, source.motions.path.stem)
    return Written(f"{len(samples)} motion{'s' * (len(samples) > 1)} for rerun, in m")


def _stage(source: Source, window: int, samples: Sequence[int]) -> Stage:
    joints = source.motions.joints[source.rows[window]][[sample - 1 for sample in samples]]
    return stage_of(joints, source.skeleton, source.fps, source.upright(window), source.data, window)


FORMATS: dict[str, Write] = {"bvh": _bvh, "glb": _glb, "mp4": _film, "gif": _film, "rrd": _rrd}
"""By what file names end in."""

OPTIONS = {
    "scene": ("glb",),
    "rigid": ("bvh",),
    "orbit": ("mp4", "gif"),
    "together": ("glb", "mp4", "gif", "rrd"),
}
"""The formats that an option is for."""


def formats_of(asked: argparse.Namespace) -> list[str]:
    """Format of each file, or of the files that the command names.

    Raises:
        SagError: it is none, or an option is for none of them.
    """
    if asked.all and asked.output is None:
        raise SagError("--all writes many files; name their folder by --output, and the formats by --to bvh --to glb")
    formats = []
    for to in asked.to:
        form = to if asked.output else Path(to).suffix.lower().removeprefix(".")
        if form not in FORMATS:
            names = [*(FORMATS if asked.output else (f".{name}" for name in FORMATS))]
            several = f"{', '.join(names[:-1])} or {names[-1]}"
            wanted = f"{several} alone, since --output names the folder" if asked.output else f"a path in {several}"
            raise SagError(f"--to {to} must be {wanted}")
        formats.append(form)
    for option, kinds in OPTIONS.items():
        if getattr(asked, option) and not set(kinds) & set(formats):
            raise SagError(f"--{option} is for a .{' or .'.join(kinds)} file; add one by --to")
    if asked.together and "bvh" in formats:
        raise SagError("--together puts samples into one file, and a .bvh file holds one person; leave one of them out")
    return formats


def lost(largest: float, mean: float) -> str:
    """How far joints are from where they were, metres in, for the terminal."""
    if largest <= EXACT:
        return "exact"
    return f"bones keep one length, joints are {1000 * largest:.1f} mm off at most, {1000 * mean:.1f} mm on average"
