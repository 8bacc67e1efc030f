"""Arrays that are filled window by window on disk, so that an interrupted conversion goes on where it stopped."""

from __future__ import annotations

import json
import os
import shutil
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from sag.data.cache import ARRAYS
from sag.data.recordings.lock import locked
from sag.errors import SagError
from sag.files import write_whole

SUFFIX = ".converting"
"""Ends the name of a folder in which a cache is being made."""

JOURNAL = "journal.jsonl"
"""File of that folder with a line for each finished window."""

Shapes = Mapping[str, tuple[int, ...]]


@dataclass(frozen=True)
class Outcome:
    """What became of a planned window.

    Attributes:
        reason: why it was dropped; empty where it was kept.
        said: more about that, such as the file.
        cloud: whether it has a row in the cloud's arrays.
    """

    reason: str = ""
    said: str = ""
    cloud: bool = False


class Scratch:
    """Arrays of a cache in the making and a journal of the windows that are finished.

    Windows come in the order of their plan. `commit` makes those since the last one last; what was not committed is
    forgotten by the next start.

    Args:
        folder: of this conversion alone; what lies in it is gone on with when it fits.
        shapes: shape of every array of the cache, for all planned windows.

    Raises:
        SagError: the disk has too little room.
    """

    def __init__(self, folder: Path, shapes: Shapes) -> None:
        self._journal = folder / JOURNAL
        _check_room(folder, shapes)
        arrays = _reopened(folder, shapes)
        self.outcomes: list[Outcome] = _read(self._journal) if arrays else []
        self._arrays = arrays or _created(folder, shapes)
        self._new: list[Outcome] = []
        # A line that was cut off by the interruption goes.
        write_whole(self._journal, lambda file: file.write(_lines(self.outcomes, 0).encode()))
        self._windows = sum(not outcome.reason for outcome in self.outcomes)
        self._clouds = sum(outcome.cloud for outcome in self.outcomes)

    def keep(self, row: Mapping[str, object]) -> None:
        """Fills the next row, and the next row of the cloud where there is one."""
        cloud = "cloud_depth" in row
        for name, value in {**row, "cloud_row": self._clouds if cloud else -1}.items():
            self._arrays[name][self._clouds if _of_cloud(name) else self._windows] = value
        self._windows += 1
        self._clouds += cloud
        self._new.append(Outcome(cloud=cloud))

    def drop(self, reason: str, said: str = "") -> None:
        """Leaves the next planned window out."""
        self._new.append(Outcome(reason, said))

    @property
    def uncommitted(self) -> int:
        """Windows that an interruption would lose."""
        return len(self._new)

    def commit(self) -> None:
        """Makes everything until now last.

        Where it is interrupted, what it was about is forgotten by this object: its lines may be in the journal
        already, and the next commit must not write them again.
        """
        new, self._new = self._new, []
        for array in self._arrays.values():
            array.flush()
        with self._journal.open("a") as file:
            file.write(_lines(new, len(self.outcomes)))
            file.flush()
            os.fsync(file.fileno())
        self.outcomes += new

    def filled(self) -> dict[str, np.ndarray]:
        """The rows that were filled."""
        return {n: a[: self._clouds if _of_cloud(n) else self._windows] for n, a in self._arrays.items()}

    @property
    def dropped(self) -> Counter[str]:
        """Reason -> windows."""
        return Counter(outcome.reason for outcome in self.outcomes if outcome.reason)

    def first(self, reason: str) -> str:
        """What was said of the first window that was dropped for a reason."""
        return next(outcome.said for outcome in self.outcomes if outcome.reason == reason)


@contextmanager
def scratch_folder(cache: Path) -> Iterator[Path]:
    """The folder in which a cache is made, for one process at a time; removed when the cache is there.

    Where it is interrupted, what is finished stays for the next try; where the data are at fault, nothing does.

    Args:
        cache: final place of the cache, whose name tells its recipe.
    """
    folder = cache.with_name(cache.name + SUFFIX)
    with locked(folder):
        try:
            yield folder
        except BaseException as error:
            if isinstance(error, SagError) or not _read(folder / JOURNAL):
                shutil.rmtree(folder, ignore_errors=True)
            raise
        shutil.rmtree(folder, ignore_errors=True)


def _check_room(folder: Path, shapes: Shapes) -> None:
    """Refuses to start where the disk would become full."""
    size = sum(np.dtype(ARRAYS[name][0]).itemsize * int(np.prod(shape)) for name, shape in shapes.items())
    taken = sum(path.stat().st_blocks * 512 for path in folder.glob("*.npy"))
    # Twice: the cache is a checked copy of the arrays that are filled here.
    needed = 2 * size - taken
    if needed > shutil.disk_usage(folder).free:
        raise SagError(
            f"{shapes['split'][0]} windows need {needed / 1e9:.1f} GB in {folder.parent}, which has less free; "
            "raise --data.init_args.stride or cloud_step, or set another --data.init_args.cache_dir"
        )


def _reopened(folder: Path, shapes: Shapes) -> dict[str, np.memmap]:
    """The arrays of an earlier try; none unless all are there and of the right shape."""
    try:
        # Opened to be read, a file that is too short is an error; to be written, it would be filled up with zeros.
        there = {name: np.load(_file(folder, name), mmap_mode="r", allow_pickle=False) for name in shapes}
    except (OSError, ValueError):
        return {}
    if any(array.shape != shapes[name] or array.dtype != ARRAYS[name][0] for name, array in there.items()):
        return {}
    return {name: np.lib.format.open_memmap(_file(folder, name), "r+") for name in shapes}


def _created(folder: Path, shapes: Shapes) -> dict[str, np.memmap]:
    """Empty arrays."""
    return {n: np.lib.format.open_memmap(_file(folder, n), "w+", ARRAYS[n][0], s) for n, s in shapes.items()}


def _read(journal: Path) -> list[Outcome]:
    """The windows that were finished, up to the first line that is not whole or not the next one's."""
    found: list[Outcome] = []
    try:
        for line in journal.read_text().splitlines():
            number, outcome = json.loads(line)
            if number != len(found):
                break
            found.append(Outcome(**outcome))
    except (OSError, ValueError, TypeError):
        pass
    return found


def _lines(outcomes: Sequence[Outcome], first: int) -> str:
    """Lines of the journal: the number of each window, from the first's, and what became of it."""
    return "".join(json.dumps([first + i, asdict(outcome)]) + "\n" for i, outcome in enumerate(outcomes))


def _file(folder: Path, name: str) -> Path:
    return folder / f"{name}.npy"


def _of_cloud(name: str) -> bool:
    """Whether an array has a row for each cloud, not for each window."""
    return name in ("cloud_depth", "cloud_intrinsics")
