"""What motions are drawn for: windows with their data set, and how other commands find it again."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int

from sag.data.base import MotionDataModule
from sag.data.selection import chosen_windows, windows_at
from sag.references import data_from, data_reference
from sag.runs import CONFIG, Run, run_folder
from sag.types import Batch


@dataclass(frozen=True)
class WindowSource:
    """Windows.

    Attributes:
        data: where they come from.
        reference: the data set as a config tells it, every path absolute.
        batches: one window each.
        about: what is printed of them.
        has_depth: whether the scene has surfaces to show.
    """

    data: MotionDataModule
    reference: dict[str, Any]
    batches: list[Batch]
    about: str
    has_depth: bool

    @property
    def index(self) -> Int[np.ndarray, " n"]:
        """Places of the windows in the data set."""
        return np.array([int(batch.index[0]) for batch in self.batches])

    @property
    def fps(self) -> float:
        """Frames a second."""
        return self.data.fps


def window_source(run: Run, place: Path, asked: argparse.Namespace) -> WindowSource:
    """Test windows of the run's own data set, or of another one with its skeleton.

    Args:
        run: what will draw.
        place: its folder or checkpoint.
        asked: `windows` or `window`, `reference` and `cache_dir`.

    Raises:
        SagError: the data set does not fit the run, or a window is none of its test windows.
    """
    reference = data_reference(asked.reference or str(run_folder(place) / CONFIG))
    told = (
        {"skeleton": run.method.skeleton.reference, "image_size": list(run.data.image_size)} if asked.reference else {}
    )
    options = {**(reference.get("init_args") or {}), **told}
    options["cache_dir"] = str((asked.cache_dir or Path(options.get("cache_dir", "data"))).resolve())
    reference = {"class_path": reference["class_path"], "init_args": options}
    data = data_from(reference, asked.reference or str(place))
    known = data.cache.rows("test").tolist()
    chosen = chosen_windows(known, asked.window, 1 if asked.windows is None else asked.windows, f"of {data.name}")
    batch = windows_at(data, "test", chosen)
    batches = [batch[[place]] for place in range(len(batch))]
    names = ", ".join(map(str, chosen[:4])) + (" and more" if len(chosen) > 4 else "")
    depth = all(bool((batch.scene.depth > 0).any()) for batch in batches)
    return WindowSource(data, reference, batches, f"test window{'s' * (len(chosen) > 1)} {names} of {data.name}", depth)
