"""Photographs as cameras and phones leave them: turned the right way up, with what they tell of the lens."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import ExifTags, Image, ImageOps

from sag.data.paths import read_file
from sag.errors import SagError

PIXEL_LIMIT = 120_000_000
"""Largest photograph that is decoded, in pixels."""

FILE_LIMIT = 256 << 20
"""Largest file of one that is read, bytes."""

FORMATS = ("JPEG", "PNG", "WEBP")

FILM_DIAGONAL = math.hypot(36, 24)
"""Of the film that focal lengths are told for, millimetres (EXIF 2.3, FocalLengthIn35mmFilm)."""

SAME_SHAPE = 0.02
"""Relative difference of two aspect ratios from which on a picture was cropped after it was taken."""


@dataclass(frozen=True, eq=False)
class Photograph:
    """A picture that somebody took.

    Attributes:
        path: its file.
        colour: as it is to be looked at, turned as its EXIF tells.
        focal: length in pixels of the picture, where the file tells it.
    """

    path: Path
    colour: UInt8[np.ndarray, "h w 3"]
    focal: float | None

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.colour.shape[0], self.colour.shape[1]

    def camera(self, fov: float | None) -> Float[np.ndarray, "3 3"]:
        """Camera matrix in its pixels, the optical axis through its middle.

        Args:
            fov: angle from the lowest row to the highest, degrees; the file's own lens when left out.

        Raises:
            SagError: the angle is none of a lens, or neither it nor the file tells one.
        """
        rows, columns = self.size
        if fov is not None and not 5 <= fov <= 150:
            raise SagError(f"--fov is {fov:g}; give the vertical angle of the picture in degrees, 5 to 150")
        focal = self.focal if fov is None else rows / 2 / math.tan(math.radians(fov) / 2)
        if focal is None:
            usual = "50 for a phone held wide, 65 held upright" if columns > rows else "65 for a phone held upright"
            raise SagError(
                f"{self.path} does not tell its lens (no 35 mm focal length in its EXIF, or cropped since); give the "
                f"vertical angle of the picture by --fov, in degrees: about {usual}"
            )
        return np.array([[focal, 0, columns / 2], [0, focal, rows / 2], [0, 0, 1.0]])

    def fov(self, camera: Float[np.ndarray, "3 3"]) -> float:
        """Vertical angle of the picture by a camera matrix, degrees."""
        return math.degrees(2 * math.atan(self.size[0] / 2 / camera[1, 1]))


def read_photograph(path: Path) -> Photograph:
    """A photograph and its lens.

    Raises:
        SagError: the file is missing, too large, damaged or in another format.
    """
    if not path.exists():
        raise SagError(f"{path} does not exist; give the picture's path")
    content = read_file(path, FILE_LIMIT)
    try:
        picture = Image.open(io.BytesIO(content), formats=FORMATS)
    except Exception as error:  # a damaged header can raise anything
        raise SagError(
            f"{path} is no {', '.join(FORMATS[:-1])} or {FORMATS[-1]} picture; convert it to JPEG"
        ) from error
    if picture.width * picture.height > PIXEL_LIMIT:
        raise SagError(
            f"{path} is {picture.width} x {picture.height} pixels, more than {PIXEL_LIMIT:,}; make it smaller"
        )
    try:
        focal = _focal(picture)
        colour = np.asarray(ImageOps.exif_transpose(picture).convert("RGB"))
    except Exception as error:  # damaged pixels and tags can raise anything
        raise SagError(
            f"{path} is damaged ({str(error) or type(error).__name__}); restore the original file"
        ) from error
    return Photograph(path, colour, focal)


def _focal(picture: Image.Image) -> float | None:
    """Focal length in pixels by the EXIF's length for film of 35 mm, which is told for the picture's diagonal."""
    tags = picture.getexif().get_ifd(ExifTags.IFD.Exif)
    millimetres = float(tags.get(ExifTags.Base.FocalLengthIn35mmFilm) or 0)
    if not (math.isfinite(millimetres) and millimetres > 0) or _cropped(picture, tags):
        return None
    return millimetres * math.hypot(picture.width, picture.height) / FILM_DIAGONAL


def _cropped(picture: Image.Image, tags: dict) -> bool:
    """Whether the picture has another shape than when it was taken, so that its lens is not the whole picture's."""
    taken = sorted(float(tags.get(tag) or 0) for tag in (ExifTags.Base.ExifImageWidth, ExifTags.Base.ExifImageHeight))
    now = sorted((picture.width, picture.height))
    return taken[0] > 0 and abs(taken[1] / taken[0] * now[0] / now[1] - 1) > SAME_SHAPE
