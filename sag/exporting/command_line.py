"""`sag export FILE.npz --to OUT`: motions from a file for other programs, and as films."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

from sag.data.known import DATA_SETS
from sag.data.motion_file import MotionFile, read_motions
from sag.errors import SagError
from sag.export import Unit
from sag.export.source import Source
from sag.exporting.formats import FORMATS, OPTIONS, Written, formats_of, lost
from sag.references import BESIDE, config_beside, data_of
from sag.skeleton import Skeleton, skeleton_named
from sag.text import plain

DESCRIPTION = """\
Writes motions of a file, as sag predict, sag extend and sag sample leave them, as BVH and animated glTF (.glb): Y up,
the origin on the floor under the person's start, one key for each frame; as films (.mp4, .gif) of the picture with the
motion running in it, or with --orbit from an eye that swings around it; and as a recording for rerun (.rrd). Up is what
the data set says of the camera, if one is told or beside the file, else the camera's own up, as if it were held level,
or a guess by --level."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag export`."""
    made = argparse.ArgumentParser(
        prog="sag export", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("file", type=Path, metavar="FILE.npz", help="motions of any length, as `sag predict` writes them")
    made.add_argument(
        "--to", action="append", required=True, metavar="OUT",
        help=f"a file that ends in .{', .'.join(FORMATS)}, or that alone with --output; may repeat",
    )  # fmt: skip
    made.add_argument("--window", type=int, metavar="N", help="by its place in the data (default: the file's first)")
    made.add_argument("--sample", type=int, metavar="K", help="which motion of the window, from 1 (default: 1)")
    made.add_argument("--all", action="store_true", help="every motion of the file; --window or --sample narrow it")
    made.add_argument("--together", action="store_true", help="every sample of a window in one file; not for .bvh")
    made.add_argument("--output", type=Path, metavar="DIR", help="folder for files named FILE-WINDOW-SAMPLE")
    made.add_argument("--orbit", action="store_true", help=".mp4, .gif: from an eye that swings around the motion")
    made.add_argument("--scene", action="store_true", help=".glb: the place that the start frame's picture shows")
    made.add_argument("--rigid", action="store_true", help=".bvh: rotations only; what that moves is printed")
    made.add_argument("--unit", choices=get_args(Unit), default="cm", help=".bvh: of lengths (default: cm); .glb has m")
    made.add_argument("--level", action="store_true", help="guess up from a person who stands or walks")
    made.add_argument(
        "--reference", metavar="DATA",
        help=f"data set of the file: {', '.join(DATA_SETS)}, or a YAML file with a key `data` (default: the "
        f"{BESIDE[0]} or {BESIDE[1]} beside it, if there is one)",
    )  # fmt: skip
    made.add_argument("--skeleton", metavar="NAME", help="name, or its .yaml file, where the file does not tell it")
    made.add_argument("--fps", type=float, metavar="F", help="frames a second, where the file does not tell it")
    made.add_argument("--cache-dir", type=Path, metavar="DIR", help="folder of the window caches, if it was moved")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the files and says what is in them; returns the exit status 0.

    Raises:
        SagError: the file or an option is refused; the sentence names it.
    """
    asked = parser().parse_args(arguments)
    formats = formats_of(asked)
    source = _source(asked, formats)
    window = next(iter(source.rows)) if asked.window is None and not asked.all else asked.window
    chosen = list(source.chosen(window, asked.sample, asked.all or asked.together))
    written = []
    for window, samples in _files(chosen, asked.together):
        for to, form in zip(asked.to, formats):
            path = _path(to, form, window, samples, asked)
            written.append(FORMATS[form](path, source, window, samples, asked))
            if not asked.all:
                print(f"{plain(str(path))}: {written[-1].about}")
    _say(source, chosen, written, asked)
    return 0


def _files(chosen: list[tuple[int, int]], together: bool) -> list[tuple[int, list[int]]]:
    """Window and samples of each file."""
    if not together:
        return [(window, [sample]) for window, sample in chosen]
    windows = dict.fromkeys(window for window, _ in chosen)
    return [(one, [sample for window, sample in chosen if window == one]) for one in windows]


def _path(to: str, form: str, window: int, samples: list[int], asked: argparse.Namespace) -> Path:
    """Where a file goes: FILE-WINDOW-SAMPLE in the folder of --output, or what --to names."""
    if asked.output is None:
        return Path(to)
    sample = "" if asked.together else f"-{samples[0]}"
    orbit = "-orbit" if asked.orbit and form in OPTIONS["orbit"] else ""
    return asked.output / f"{asked.file.stem}-{window}{sample}{orbit}.{form}"


def _source(asked: argparse.Namespace, formats: Sequence[str]) -> Source:
    motions = read_motions(asked.file, frames=None)
    reference = asked.reference
    # What is beside the file is opened only where it is of use, since that may mean building it.
    shows = asked.scene or {"mp4", "gif", "rrd"} & set(formats)
    if reference is None and (shows or not asked.level):
        reference = config_beside(asked.file)
    data = None if reference is None else data_of(reference, asked.cache_dir)
    fps = motions.fps or asked.fps or (data.fps if data else None)
    if fps is None:
        raise SagError(f"{asked.file} does not tell its frames a second; give --fps")
    return Source(motions, data.skeleton if data else _skeleton(asked, motions), fps, data, asked.level)


def _skeleton(asked: argparse.Namespace, motions: MotionFile) -> Skeleton:
    """The skeleton that is told, or that the file tells."""
    name, count = asked.skeleton or motions.skeleton, motions.joints.shape[3]
    if name is None:
        raise SagError(f"{asked.file} does not tell its skeleton; name it by --skeleton, such as gta_im_19")
    try:
        skeleton = skeleton_named(name)
    except SagError as error:
        raise SagError(f"{asked.file}: {error}, by --skeleton") from error
    if len(skeleton.joints) != count:
        raise SagError(
            f"{asked.file} has {count} joints, and skeleton {name} has {len(skeleton.joints)}; name the right one by "
            "--skeleton"
        )
    return skeleton


def _say(source: Source, chosen: list[tuple[int, int]], written: list[Written], asked: argparse.Namespace) -> None:
    """What was written, and how it stands."""
    frames = f"{source.motions.joints.shape[2]} frames at {source.fps:g} fps"
    if asked.all:
        files = f"{len(written):,} file{'s are' if len(written) > 1 else ' is'} in {plain(str(asked.output))}"
        about = f": {written[0].about}" if len(written) == 1 else ""
        print(f"{files}: {len(chosen):,} motion{'s' * (len(chosen) > 1)}, {frames}{about}")
        rigid = [one.form for one in written if one.form is not None and one.form.rigid]
        if rigid:
            worst = lost(max(form.largest for form in rigid), sum(form.mean for form in rigid) / len(rigid))
            print(f"{len(rigid):,} with rotations only: {worst}")
    else:
        numbers = ", ".join(str(sample) for _, sample in chosen)
        print(f"window {chosen[0][0]}, sample{'s' * (len(chosen) > 1)} {numbers}: {frames}")
    print(f"Y is up, {source.up}; the origin is on the floor under the start")
