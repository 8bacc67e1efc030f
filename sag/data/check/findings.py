"""What is found in one recording of any data set, and the lines on it that all reports share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from sag.data.check.bodies import Bones
from sag.data.check.report import Line, by_recording, several, within
from sag.data.recordings.plan import spread
from sag.errors import SagError

Recorded = TypeVar("Recorded")
Looked = TypeVar("Looked")


@dataclass
class Findings(Generic[Recorded, Looked]):
    """One recording.

    Attributes:
        folder: its place.
        recording: what was read; nothing where it is broken.
        broken: sentences on files that are, the recording's own or pictures.
        looks: at the decoded frames.
        bones: their lengths; nothing where they are not known.
        jumps: frames after which the root is elsewhere.
    """

    folder: Path
    recording: Recorded | None = None
    broken: list[str] = field(default_factory=list)
    looks: list[Looked] = field(default_factory=list)
    bones: Bones | None = None
    jumps: list[int] = field(default_factory=list)

    def look_at(self, frames: Sequence[int], count: int | None, look: Callable[[int], Looked]) -> None:
        """Decodes so many of the frames; a file that cannot be read is told among the broken ones."""
        for frame in spread(frames, count):
            try:
                self.looks.append(look(frame))
            except SagError as error:
                self.broken.append(str(error))


def decoded_line(everything: Sequence[Findings]) -> Line:
    """How many frames' pictures were looked at."""
    looks = sum(len(found.looks) for found in everything)
    return Line("decoded", f"the pictures of {looks:,} frames", "ok" if looks else "look")


def broken_line(everything: Sequence[Findings], root: Path) -> Line:
    """The files that are broken, told from the root on."""
    broken = [sentence for found in everything for sentence in found.broken]
    if not broken:
        return Line("broken files", "none", "ok")
    said = f"{len(broken)}, in {several(sum(bool(found.broken) for found in everything), 'recording')}"
    return Line("broken files", said, "broken", within(broken, root))


def jumps_line(everything: Sequence[Findings], step: float) -> Line:
    """Teleports of the root, by more than a step (metres), with their frames."""
    jumps = sum(len(found.jumps) for found in everything)
    where = by_recording((found.folder, found.jumps) for found in everything)
    said = f"{jumps}, which no window goes over: by more than {step:g} m; after the frames"
    return Line("root teleports", said if jumps else "0", details=where)
