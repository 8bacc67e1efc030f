"""What windows a data set gives, said and drawn."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sag.data.cache import PERSON, SPLITS
from sag.data.check.report import Line, Report, Section, several
from sag.data.recordings.filters import BROKEN
from sag.data.recordings.plan import Plan, Window, spread
from sag.data.sheet import Tile, draw_sheet, projected
from sag.errors import SagError
from sag.text import plain
from sag.types import FRAMES


@dataclass(frozen=True)
class Inspection:
    """What a check found, and what its sheet is drawn of.

    Attributes:
        report: for the reader.
        plan: the windows that training would get; nothing where no recording can be read.
        module: the data module that would read them.
    """

    report: Report
    plan: Plan | None
    module: Any

    def draw(self, path: Path, count: int) -> None:
        """Writes a PNG of windows, spread over all that there are.

        Raises:
            SagError: there is no window whose pictures can be read.
        """
        windows = sorted({(w.recording, w.start): w for w in (self.plan.windows if self.plan else ())}.items())
        tiles: list[Tile] = []
        for _, window in spread(windows, count):
            if tile := self._tile(window):
                tiles.append(tile)
        if not tiles:
            raise SagError(f"{self.module.root} has no window to draw on {path}")
        draw_sheet(tiles, self.module.skeleton, path, with_start=True)

    def _tile(self, window: Window) -> Tile | None:
        """One window; nothing where its picture is broken or hides the person."""
        assert self.plan is not None
        folder = self.plan.folders[window.recording]
        try:
            stored = self.module.reader.window(self.module.reader.read(folder), window.start, self.module.form, False)
        except SagError:
            return None
        if stored is None:
            return None
        joints = projected(stored["joints"], stored["intrinsics"])
        caption = f"{folder.name}, room {self.plan.rooms[window.recording]}, frame {window.start}"
        return Tile(stored["image"], joints, plain(caption), stored["ids"] == PERSON)


def windows_section(plan: Plan | None, stride: int, place: str, broken: int) -> Section:
    """How many windows training would get, and why not more.

    Args:
        plan: the windows; nothing where no recording can be read.
        stride: frames from one window to the next, as asked for.
        place: folder of the recordings.
        broken: recordings that are left out.
    """
    title = f"Windows of {FRAMES} frames in {place}, one asked for every {several(stride, 'frame')}"
    dropped = Counter({BROKEN: broken}) + (plan.dropped if plan else Counter())
    windows = plan.windows if plan else ()
    splits = Counter(window.split for window in windows)
    kept = ", ".join(f"{splits[split]:,} {split}" for split in SPLITS)
    lines = [Line("kept", kept if windows else "none", "ok" if windows else "broken")]
    lines += [Line("dropped", f"{count:,}: {reason}") for reason, count in dropped.most_common() if count]
    if len(lines) > 2:
        lines.append(Line("", "a window is counted once, under the first reason against it"))
    lines += [Line("notes", note, "look") for note in (plan.notes if plan else ())]
    return Section(title, tuple(lines))
