"""The window of somebody's own photograph: camera, place and first pose from options, depth from the decoder."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import Windows
from sag.data.photo import PhotoDataModule, Place, read_photograph, read_pose, standing_pose, write_photo
from sag.data.photo.place import FACINGS, FARTHEST, NEAREST
from sag.errors import SagError
from sag.geometry.camera import project
from sag.report.results import read_json
from sag.runs import Run, run_folder
from sag.sample.source import WindowSource

DISTANCE = 4.0
"""Metres from the camera at which a person starts where nothing tells: the median of the synthetic rooms."""

USUAL = 2.0
"""Deviations from the mean within which nearly all people of a training set start."""

FRAME_RATE = 30.0
"""Frames a second that a run was trained at, where its folder does not tell: that of every data set built in."""

MIDDLE = 0.06
"""Share of the rows and columns over which the depth in the middle is taken, where the person will be."""

OF_PHOTOS = ("start", "fov", "pitch", "distance", "facing", "pose")
OF_WINDOWS = ("windows", "window", "reference")


def add_photo_options(group: Any) -> None:
    """Adds the options of a photograph to a parser or a group of one."""
    group.add_argument("--image", type=Path, metavar="FILE", help="JPEG, PNG or WebP of a room, best without people")
    group.add_argument("--start", metavar="X,Y", help="pixel of the picture at which the person's hips are at first")
    group.add_argument("--fov", type=float, metavar="DEGREES", help="vertical angle of the picture (default: its EXIF)")
    group.add_argument("--pitch", type=float, metavar="DEGREES", help="how far the camera looks down (default: 0)")
    group.add_argument(
        "--distance", type=float, metavar="METRES",
        help=f"of the person along the camera's axis (default: the depth decoder's guess, {DISTANCE:g} without one)",
    )  # fmt: skip
    group.add_argument(
        "--facing", metavar="WAY", help=f"{', '.join(FACINGS)}, or degrees to the right of away (default: away)"
    )
    group.add_argument(
        "--pose", type=Path, metavar="FILE.npz", help="first pose (default: a person of 1.75 m who stands)"
    )


def check_photo_options(asked: argparse.Namespace) -> None:
    """Refuses options of photographs without one, and options of windows with one.

    Raises:
        SagError: the sentence names the option.
    """
    wrong = OF_PHOTOS if asked.image is None else OF_WINDOWS
    if given := [name for name in wrong if getattr(asked, name) is not None]:
        other = "an --image" if asked.image is None else "a data set, and --image is a photograph"
        raise SagError(f"--{given[0]} is for {other}")
    if asked.image is not None and asked.start is None:
        raise SagError("--image needs --start X,Y: the pixel at which the person's hips are, from the top left corner")
    if asked.pose is not None and asked.facing is not None:
        raise SagError("--facing turns the person who stands by default; turn the joints of --pose themselves")


def photo_source(run: Run, place: Path, asked: argparse.Namespace) -> WindowSource:
    """The window of the photograph, written to `photo` in the output folder.

    The decoder looks at the picture as a method does, with the start at its centre. Where a distance is told, its
    depth is scaled until the person is there; where none is, the person is where its depth says.

    Args:
        run: what will draw.
        place: its folder or checkpoint.
        asked: options of `add_photo_options`, and `output`.

    Raises:
        SagError: the photograph or an option is refused.
    """
    photo = read_photograph(asked.image)
    camera, skeleton = photo.camera(asked.fov), run.method.skeleton
    folder, fps = (asked.output / "photo").resolve(), _frame_rate(place)

    def written(distance: float, depth: Float[Tensor, "h w"] | None) -> PhotoDataModule:
        where = Place(camera, _start(asked.start), distance, asked.pitch or 0.0, _facing(asked.facing))
        pose = where.standing(standing_pose(skeleton)) if asked.pose is None else None
        joints = where.root + read_pose(asked.pose, skeleton) if pose is None else pose
        values = None if depth is None else depth.double().numpy()
        return write_photo(folder, photo, where, joints, skeleton, run.data.image_size, fps, values)

    distance = asked.distance or DISTANCE
    data = written(distance, None)
    depth = _depth(run, data)
    if depth is not None:
        guess = _middle(depth)
        distance = asked.distance or min(max(guess, NEAREST), FARTHEST)
        data = written(distance, depth * distance / guess)
    batch = Windows(data.cache, "test", skeleton)[0]
    about = (
        f"{photo.path.name}, {photo.size[1]} x {photo.size[0]} pixels, {photo.fov(camera):.0f}° from bottom to top "
        f"({'its EXIF' if asked.fov is None else 'as told'}), camera looking down by {asked.pitch or 0:g}°\n"
        f"the person starts {distance:.1f} m away: {_scale(asked.distance, depth)}"
        f"{_cautions(run, batch.motion.joints[0, 0], camera, photo.size)}"
    )
    return WindowSource(data, _reference(folder, data), [batch], about, depth is not None)


def _start(text: str) -> tuple[float, float]:
    parts = text.split(",")
    try:
        x, y = map(float, parts)
    except ValueError:
        raise SagError(f"--start {text} must be two numbers of pixels, across and down, such as 640,420") from None
    return x, y


def _facing(text: str | None) -> float:
    try:
        return FACINGS[text or "away"] if (text or "away") in FACINGS else float(text or 0)
    except ValueError:
        raise SagError(f"--facing {text} must be {', '.join(FACINGS)}, or degrees") from None


@torch.no_grad()
def _depth(run: Run, data: PhotoDataModule) -> Float[Tensor, "h w"] | None:
    """What the run takes the depth of the photograph to be, metres, if it was trained to."""
    batch = Windows(data.cache, "test", run.method.skeleton)[0].to(run.method.device)
    predicted = run.method.predicted_depth(batch)
    return None if predicted is None else predicted[0].float().cpu()


def _middle(depth: Float[Tensor, "h w"]) -> float:
    """Depth at the centre, metres, where methods see the person in training."""
    (top, bottom), (left, right) = ((int(n * (1 - MIDDLE) / 2), -int(-n * (1 + MIDDLE) // 2)) for n in depth.shape)
    return float(depth[top:bottom, left:right].median())


def _scale(told: float | None, depth: Tensor | None) -> str:
    """How far the metres of a photograph can be trusted."""
    if told is not None:
        return "as told" + ("; the depth around is the decoder's guess, scaled to it" if depth is not None else "")
    if depth is None:
        return "assumed, since this run has no depth decoder; give --distance, on which the scale of all depends"
    return "the depth decoder's guess, on which the scale of all depends; give --distance if you know better"


def _cautions(run: Run, joints: Float[Tensor, "j 3"], camera: Float[np.ndarray, "3 3"], size: tuple[int, int]) -> str:
    """Lines on what is unlike anything that the run was trained on, or outside of the picture."""
    skeleton, said = run.method.skeleton, []
    scale = getattr(getattr(run.method, "sampler", None), "scale", None)
    if scale is not None and scale.units == "zscore":
        mean, deviation = (float(each[skeleton.root_index, 2]) for each in (scale.initial_mean, scale.initial_std))
        low, high = max(0.0, mean - USUAL * deviation), mean + USUAL * deviation
        if not low <= float(joints[skeleton.root_index, 2]) <= high:
            said.append(f"people it was trained on start {low:.1f} to {high:.1f} m away; give --distance")
    pixels = project(joints[None, skeleton.feet].double(), torch.from_numpy(camera)[None])
    if (pixels < 0).any() or (pixels > torch.tensor([size[1], size[0]])).any():
        said.append("the feet are outside of the picture; a larger --distance or another --start brings them in")
    return "".join(f"\ncaution: {line}" for line in said)


def _frame_rate(place: Path) -> float:
    """Frames a second of what a run was tested on, if it was."""
    figures = run_folder(place) / "metrics.json"
    return float(read_json(figures).get("data", {}).get("fps", FRAME_RATE)) if figures.is_file() else FRAME_RATE


def _reference(folder: Path, data: PhotoDataModule) -> dict[str, Any]:
    options = {
        "cache_dir": str(folder),
        "skeleton": data.skeleton.reference,
        "image_size": list(data.image_size),
    }
    return {"class_path": f"{PhotoDataModule.__module__}.{PhotoDataModule.__name__}", "init_args": options}
