"""Where motions to be looked at come from: trained runs that are sampled now, and files, all on the same windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from sag.data.base import MotionDataModule
from sag.data.motion_file import MotionFile, read_motions
from sag.data.selection import windows_at
from sag.errors import SagError
from sag.references import config_beside, data_of
from sag.runs import Run, read_runs
from sag.types import Batch


@dataclass(frozen=True)
class Sources:
    """What is shown.

    Attributes:
        data: where all windows come from.
        runs: that are sampled.
        files: motions, by the name of their row.
    """

    data: MotionDataModule
    runs: list[Run]
    files: dict[str, MotionFile]

    @property
    def names(self) -> list[str]:
        """Of the rows: runs, then files."""
        return [run.name for run in self.runs] + list(self.files)

    @cached_property
    def rows(self) -> dict[str, dict[int, int]]:
        """For each file, its row of each window of the data set."""
        return {name: motions.by_window(self.data) for name, motions in self.files.items()}

    @property
    def places(self) -> list[int]:
        """Test windows, by place in the data set, that every file continues."""
        known = self.data.cache.rows("test").tolist()
        return [place for place in known if all(place in rows for rows in self.rows.values())]

    def batches(self, places: Sequence[int]) -> list[Batch]:
        """Windows one by one, with their depth clouds where the data set has them.

        Args:
            places: of the windows in the data set.
        """
        batch = windows_at(self.data, "test", places, with_cloud=True)
        return [batch[[turn]] for turn in range(len(batch))]

    def motions(self, batch: Batch, samples: int, seed: int) -> dict[str, Float[Tensor, "k t j 3"]]:
        """Motions of each row that continue a window, metres, camera frame of frame 0.

        Args:
            batch: the window alone.
            samples: motions of each run, and of each file at most.
            seed: of what is drawn.
        """
        place = int(batch.index[0])
        rows = {run.name: _sampled(run, batch, samples, seed) for run in self.runs}
        for name, motions in self.files.items():
            rows[name] = torch.from_numpy(motions.joints[self.rows[name][place]][:samples]).float()
        return rows


def read_sources(
    paths: Sequence[Path], reference: str | None = None, cache_dir: Path | None = None, frames: int | None = None
) -> Sources:
    """Runs, sweeps and files of motions that have the same windows.

    Args:
        paths: folders of runs and of sweeps, and `.npz` of motions.
        reference: what tells the data set, where not the runs or a config beside a file are to; see `data_of`.
        cache_dir: where the window caches are, if they were moved.
        frames: of every motion of a file; any number when left out.

    Raises:
        SagError: one cannot be read, two have one name, or they have not the same windows.
    """
    files = [path for path in paths if path.suffix == ".npz" or path.is_file()]
    folders = [path for path in paths if path not in files]
    if missing := [path for path in paths if not path.exists()]:
        raise SagError(f"{missing[0]} does not exist; name the folder of a run or sweep, or a .npz of motions")
    motions = {_name(path): read_motions(path, frames) for path in files}
    runs = read_runs(folders, cache_dir) if folders else []
    names = [run.name for run in runs] + [_name(path) for path in files]
    if twice := [name for name in names if names.count(name) > 1]:
        raise SagError(f"two of the sources are called {twice[0]!r}, and rows are told apart by name: rename one")
    data = runs[0].data if runs and reference is None else data_of(reference or _beside(files), cache_dir)
    for run in runs:
        if run.data.cache.fingerprint != data.cache.fingerprint:
            raise SagError(f"--reference {reference} has not the windows that {run.name} was trained for")
    return Sources(data, runs, motions)


def _name(path: Path) -> str:
    """What a file's row is called: by its folder where it has the usual name."""
    return path.resolve().parent.name if path.stem == "predictions" else path.stem


def _beside(paths: Sequence[Path]) -> str:
    """The config beside a file that tells the data set."""
    for path in paths:
        if found := config_beside(path):
            return found
    raise SagError(f"{paths[0]} does not tell its data set; name it with --reference, such as rooms or a config")


@torch.no_grad()
def _sampled(run: Run, batch: Batch, samples: int, seed: int) -> Float[Tensor, "k t j 3"]:
    """Motions of a window, the same whatever other windows are shown."""
    device = run.method.device
    generator = torch.Generator(device).manual_seed(seed)
    drawn = run.method.samples(batch.to(device), samples, generator)
    return torch.stack([motion.joints[0] for motion in drawn]).float().cpu()
