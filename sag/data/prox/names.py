"""What the names of PROX's recordings and frames say."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise

from sag.errors import SagError

FPS = 30.0
"""Nominal frames a second. Frames are taken as they come: the clock in their names trembles by several milliseconds,
and motion resampled by it would tremble too."""

_FRAME = re.compile(r"s\d+_frame_(\d+)__(\d+)\.(\d+)\.(\d+)\.(\d+)", re.ASCII)


@dataclass(frozen=True)
class RecordingName:
    """Name of a recording, such as `MPH1Library_00034_01`.

    Attributes:
        scene: where it was made; MPH1Library, MPH11 and MPH112 begin alike, so names are compared whole.
        subject: who was recorded.
        take: the how manieth recording of this subject there.
    """

    scene: str
    subject: str
    take: str

    @classmethod
    def of(cls, name: str) -> RecordingName:
        """Reads a name.

        Raises:
            SagError: it does not have three parts.
        """
        parts = name.split("_")
        if len(parts) != 3 or not all(parts):
            raise SagError(f"recordings/{name} is not named Scene_Subject_Take, as MPH16_00157_01; move it elsewhere")
        return cls(*parts)

    def is_of(self, subjects: tuple[int, ...]) -> bool:
        """Whether the subject is one of these; names write numbers with leading zeros."""
        return self.subject.isdecimal() and int(self.subject) in subjects


@dataclass(frozen=True)
class FrameName:
    """Name of a frame, such as `s001_frame_00001__00.00.00.029`.

    Attributes:
        stem: the name, without the folder and the ending.
        number: counted from 1.
        seconds: when it was recorded, since the recording began.
    """

    stem: str
    number: int
    seconds: float

    @classmethod
    def of(cls, stem: str, folder: str) -> FrameName:
        """Reads a name.

        Args:
            stem: the name.
            folder: what an error calls the place of the file.

        Raises:
            SagError: it is another kind of name.
        """
        found = _FRAME.fullmatch(stem)
        if found is None:
            raise SagError(
                f"{folder} holds a picture called {stem!r}, not as s001_frame_00001__00.00.00.029; move it elsewhere"
            )
        number, hours, minutes, seconds, thousandths = (int(part) for part in found.groups())
        return cls(stem, number, 3600 * hours + 60 * minutes + seconds + thousandths / 1000)


def in_order(frames: list[FrameName], folder: str) -> tuple[FrameName, ...]:
    """Frames by their numbers.

    Args:
        frames: of one recording.
        folder: what an error calls the place of the files.

    Raises:
        SagError: two have the same number, or the clock runs backwards.
    """
    ordered = sorted(frames, key=lambda frame: frame.number)
    for before, after in pairwise(ordered):
        if after.number == before.number or after.seconds <= before.seconds:
            raise SagError(
                f"{folder}: frame {after.stem} does not come after {before.stem} in number and in time; "
                "restore the original files"
            )
    return tuple(ordered)
