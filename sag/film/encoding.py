"""Pictures in a row as MP4, by ffmpeg, and as GIF, by Pillow alone."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image

from sag.errors import SagError
from sag.files import write_whole, writing_in

Frame = UInt8[np.ndarray, "h w 3"]

SUFFIXES = (".mp4", ".gif")

QUALITY = "20"
"""Of H.264, as its constant rate factor."""

COLOURS = 255
"""Of a GIF; all its frames share them, so that what stands still does not flicker."""

SHADES = (0.35, 0.55, 0.75, 0.9, 1.0, 1.15)
"""Of each colour that must not be lost."""


def every_frame(path: Path, fps: float) -> int:
    """How many frames of a motion make one of a film: all for MP4, about 15 a second for GIF, which grow large."""
    return 1 if path.suffix.lower() == ".mp4" else max(1, round(fps / 15))


def write_film(path: Path, frames: Iterable[Frame], fps: float, vivid: Float[np.ndarray, "n 3"] | None = None) -> None:
    """Writes a film, whole or not at all.

    Args:
        path: ends in .mp4 or .gif; GIFs go round without end.
        frames: of one size, rows and columns even.
        fps: frames of the film a second.
        vivid: colours in [0, 1] that a GIF must keep, however few pixels have them.

    Raises:
        SagError: the path is none of a film, ffmpeg is not installed or fails, or the file cannot be written.
    """
    if path.suffix.lower() not in SUFFIXES or path.is_dir():
        raise SagError(f"{path} must be a file that ends in {' or '.join(SUFFIXES)}")
    with writing_in(path, "name another place"):
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix.lower() == ".mp4":
            _write_mp4(path, iter(frames), fps)
        else:
            _write_gif(path, iter(frames), fps, np.zeros((0, 3)) if vivid is None else vivid)


def _write_mp4(path: Path, frames: Iterator[Frame], fps: float) -> None:
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise SagError(
            f"{path} needs ffmpeg: pip install imageio-ffmpeg (the extra `video`), or name a .gif"
        ) from error
    first = next(frames)
    partial = path.with_name(f".{path.stem}.{os.getpid()}.mp4")
    writer = imageio_ffmpeg.write_frames(
        str(partial), first.shape[1::-1], fps=fps, codec="libx264", quality=None, macro_block_size=2,
        output_params=["-crf", QUALITY, "-preset", "fast", "-movflags", "+faststart"], ffmpeg_log_level="error",
    )  # fmt: skip
    try:
        writer.send(None)
        for frame in chain([first], frames):
            writer.send(np.ascontiguousarray(frame))
        writer.close()
        partial.replace(path)
    except OSError as error:
        raise SagError(f"{path}: ffmpeg failed ({error}); name a .gif instead, or another place") from error
    finally:
        partial.unlink(missing_ok=True)


def _write_gif(path: Path, frames: Iterator[Frame], fps: float, vivid: np.ndarray) -> None:
    pictures = [Image.fromarray(frame) for frame in frames]
    palette = _palette(pictures, vivid)
    small = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    # A GIF counts hundredths of a second: the pauses differ by one, so that they add up.
    times = np.rint(np.arange(len(small) + 1) * 100 / fps).astype(int)
    pauses = [int(10 * pause) for pause in np.diff(times)]
    rest = {"save_all": True, "append_images": small[1:], "duration": pauses, "loop": 0, "optimize": False}
    write_whole(path, lambda file: small[0].save(file, "GIF", **rest))


def _palette(pictures: list[Image.Image], vivid: np.ndarray) -> Image.Image:
    """The colours of all frames: shades of those that must be kept, and what a few of the frames have most."""
    shades = np.rint(255 * np.array(SHADES)[:, None, None] * vivid).clip(0, 255).astype(int).reshape(-1, 3)
    few = [pictures[place] for place in np.linspace(0, len(pictures) - 1, 5).round().astype(int)]
    count = COLOURS - len(shades)
    common = Image.fromarray(np.concatenate([np.asarray(one) for one in few])).quantize(count).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([*common[: 3 * count], *shades.ravel().tolist()])
    return palette
