"""The pictures of a recording: colours and depth of some frames, and perhaps where the person is."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, UInt8

from sag.data.folder.files import GUIDE, MOTION
from sag.data.pictures import picture_size, read_16_bit, read_colour, read_grey
from sag.errors import SagError

COLOUR, DEPTH, PERSON = (".jpg", ".png"), "_depth.png", "_person.png"
"""What follows the number of a frame in the names of its pictures."""

STEPS_A_METRE = 1000
"""Of the stored depth; 0 is where it is not known."""


@dataclass(frozen=True)
class Pictures:
    """The pictures of a recording.

    Attributes:
        folder: its files.
    """

    folder: Path

    @cached_property
    def coloured(self) -> dict[int, Path]:
        """Colour picture of each frame that has one."""
        return {int(path.stem): path for path in sorted(self.folder.iterdir()) if _is_colour(path)}

    @cached_property
    def complete(self) -> frozenset[int]:
        """Frames that have colour and depth."""
        return frozenset(frame for frame in self.coloured if self.file(frame, DEPTH).exists())

    @cached_property
    def size(self) -> tuple[int, int]:
        """Rows and columns, by the first.

        Raises:
            SagError: it is damaged.
        """
        return picture_size(self.coloured[min(self.complete)])

    def check(self, frames: int) -> None:
        """Refuses pictures that cannot be those of a recording.

        Args:
            frames: of the recording.

        Raises:
            SagError: there is no complete frame, one that the recording lacks, or one in two files.
        """
        if not self.complete:
            raise SagError(f"{self.folder} has no frame with both colour, 00000.jpg or .png, and 00000{DEPTH}; {GUIDE}")
        if (last := max(self.coloured)) >= frames:
            path = self.coloured[last]
            raise SagError(f"{path} is of a frame that {MOTION} lacks: it tells {frames}, and the first is 00000")
        for stem, count in Counter(path.stem for path in self.folder.iterdir() if _is_colour(path)).items():
            if count > 1:
                raise SagError(f"{self.folder / stem} is there as .jpg and as .png; leave one of them")

    def colour(self, frame: int) -> UInt8[np.ndarray, "h w 3"]:
        """Colours of a frame.

        Raises:
            SagError: the picture is damaged or of another size than the first.
        """
        return self._sized(read_colour(self.coloured[frame]), self.coloured[frame])

    def depth(self, frame: int) -> Float[np.ndarray, "h w"]:
        """Planar z of a frame, metres, 0 where it is not known.

        Raises:
            SagError: the picture is damaged, not of 16 bits, or of another size than the first.
        """
        path = self.file(frame, DEPTH)
        return self._sized(read_16_bit(path), path) / STEPS_A_METRE

    def person(self, frame: int) -> Bool[np.ndarray, "h w"] | None:
        """Where the person is in a frame; nothing where no picture tells it.

        Raises:
            SagError: the picture is damaged or of another size than the first.
        """
        path = self.file(frame, PERSON)
        return self._sized(read_grey(path), path) > 0 if self.tells_person(frame) else None

    def tells_person(self, frame: int) -> bool:
        """Whether a frame has a picture of where the person is."""
        return self.file(frame, PERSON).exists()

    def file(self, frame: int, suffix: str) -> Path:
        """A file beside the colours of a frame."""
        return self.folder / f"{self.coloured[frame].stem}{suffix}"

    def _sized(self, values: np.ndarray, path: Path) -> np.ndarray:
        if values.shape[:2] != self.size:
            raise SagError(
                f"{path} has {values.shape[:2]} pixels, and the recording's first picture {self.size}; resample one"
            )
        return values


def _is_colour(path: Path) -> bool:
    """Whether a file is named as the colours of a frame: its number, of five digits or more."""
    stem = path.stem
    return path.suffix in COLOUR and stem.isascii() and stem.isdecimal() and f"{int(stem):05d}" == stem
