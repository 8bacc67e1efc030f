"""`sag export FILE.npz --to OUT`: motions from a file as BVH and animated glTF for other programs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import get_args

from sag.data.known import DATA_SETS
from sag.data.motion_file import MotionFile, read_motions
from sag.errors import SagError
from sag.export import BvhForm, Surface, Unit, write_bvh, write_glb
from sag.export.bvh import EXACT
from sag.export.source import Source
from sag.references import BESIDE, config_beside, data_of
from sag.skeleton import Skeleton, skeleton_named
from sag.text import plain

DESCRIPTION = """\
Writes motions of a file, as sag predict and sag extend leave them, as BVH and as animated glTF (.glb): Y up, the
origin on the floor under the person's start, one key for each frame. Up is what the data set says of the camera, if
one is told or beside the file, else the camera's own up, as if it were held level, or a guess by --level."""

FORMATS = ("bvh", "glb")


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag export`."""
    made = argparse.ArgumentParser(
        prog="sag export", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("file", type=Path, metavar="FILE.npz", help="motions of any length, as `sag predict` writes them")
    made.add_argument(
        "--to", action="append", required=True, metavar="OUT",
        help="a file that ends in .bvh or .glb, or bvh or glb alone with --output; may repeat",
    )  # fmt: skip
    made.add_argument("--window", type=int, metavar="N", help="by its place in the data (default: the file's first)")
    made.add_argument("--sample", type=int, metavar="K", help="which motion of the window, from 1 (default: 1)")
    made.add_argument("--all", action="store_true", help="every motion of the file; --window or --sample narrow it")
    made.add_argument("--output", type=Path, metavar="DIR", help="folder for files named FILE-WINDOW-SAMPLE")
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
    formats = _formats(asked)
    source = _source(asked)
    surface_of = lru_cache(maxsize=1)(source.surface)  # the samples of a window share it
    chosen = list(source.chosen(asked.window, asked.sample, asked.all))
    forms = []
    for window, sample in chosen:
        surface = surface_of(window) if asked.scene else None
        for to, form in zip(asked.to, formats):
            path = asked.output / f"{asked.file.stem}-{window}-{sample}.{form}" if asked.output else Path(to)
            forms.append(_write(path, source, (window, sample), surface, asked))
            if not asked.all:
                print(f"{plain(str(path))}: {_about(forms[-1], surface, asked.unit)}")
    _say(source, chosen, forms, asked)
    return 0


def _formats(asked: argparse.Namespace) -> list[str]:
    """Format of each file, or of the files that the command names."""
    if asked.all and asked.output is None:
        raise SagError("--all writes many files; name their folder by --output, and the formats by --to bvh --to glb")
    formats = []
    for to in asked.to:
        form = to if asked.output else Path(to).suffix.lower().removeprefix(".")
        if form not in FORMATS:
            wanted = "bvh or glb alone, since --output names the folder" if asked.output else "a path in .bvh or .glb"
            raise SagError(f"--to {to} must be {wanted}")
        formats.append(form)
    for option, form in (("scene", "glb"), ("rigid", "bvh")):
        if getattr(asked, option) and form not in formats:
            raise SagError(f"--{option} is for a .{form} file; add one by --to")
    return formats


def _source(asked: argparse.Namespace) -> Source:
    motions = read_motions(asked.file, frames=None)
    reference = asked.reference
    # What is beside the file is opened only where it is of use, since that may mean building it.
    if reference is None and (asked.scene or not asked.level):
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


def _write(
    path: Path, source: Source, which: tuple[int, int], surface: Surface | None, asked: argparse.Namespace
) -> BvhForm | None:
    """Writes one file; of a BVH file gives back what it is."""
    joints = source.joints(*which)
    if path.suffix.lower() == ".bvh":
        return write_bvh(path, joints, source.skeleton, source.fps, asked.unit, asked.rigid or None)
    write_glb(path, joints, source.skeleton, source.fps, surface, source.view(which[0]))
    return None


def _about(form: BvhForm | None, surface: Surface | None, unit: Unit) -> str:
    """What is in one file."""
    if form is None:
        return "a body" + ("" if surface is None else f" in a scene of {len(surface.triangles):,} triangles") + ", in m"
    if not form.rigid:
        return f"rotations, and the place of every joint since bones stretch: exact, in {unit}"
    return f"rotations only: {_lost(form.largest, form.mean)}, in {unit}"


def _lost(largest: float, mean: float) -> str:
    if largest <= EXACT:
        return "exact"
    return f"bones keep one length, joints are {1000 * largest:.1f} mm off at most, {1000 * mean:.1f} mm on average"


def _say(source: Source, chosen: list[tuple[int, int]], forms: list[BvhForm | None], asked: argparse.Namespace) -> None:
    """What was written, and how it stands."""
    frames = f"{source.motions.joints.shape[2]} frames at {source.fps:g} fps"
    if asked.all:
        print(f"{len(forms):,} files are in {plain(str(asked.output))}: {len(chosen):,} motions, {frames}")
        rigid = [form for form in forms if form is not None and form.rigid]
        if rigid:
            lost = _lost(max(form.largest for form in rigid), sum(form.mean for form in rigid) / len(rigid))
            print(f"{len(rigid):,} with rotations only: {lost}")
    else:
        print(f"window {chosen[0][0]}, sample {chosen[0][1]}: {frames}")
    print(f"Y is up, {source.up}; the origin is on the floor under the start")
