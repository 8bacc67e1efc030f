"""The window cache: one folder of memory-mapped arrays that every data set is read from.

A folder is named by the hash of its recipe, written under a temporary name, checked by sha256 and
renamed when it is whole. `ARRAYS` is its schema.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from sag.data.index import read_index, write_index
from sag.errors import SagError
from sag.files import sha256_of, write_json

SPLITS = ("train", "val", "test")
"""Names of the splits; the `split` array holds a place in this tuple."""

DEPTH_UNIT = 0.001
"""Metres for one step of the stored depth (uint16); 0 is unknown, so the farthest is 65.5 m."""

PERSON = 255
"""The person's number in the stored ids; 0 is what has no id."""

ARRAYS: dict[str, tuple[str, str]] = {
    "joints": ("float32", "n 65 j 3: metres, camera frame of frame 0"),
    "image": ("uint8", "n h w 3: colours, the start root at the centre"),
    "depth": ("uint16", "n h w: planar z in steps of DEPTH_UNIT, the person included"),
    "ids": ("uint8", "n h w: instances, PERSON where the person stands"),
    "intrinsics": ("float32", "n 3 3: camera of the picture"),
    "world2cam": ("float64", "n 4 4: column vectors, metres, world z up"),
    "split": ("uint8", "n: place in SPLITS"),
    "scene": ("int32", "n: room"),
    "sequence": ("int32", "n: recording"),
    "start": ("int32", "n: frame of the recording where the window starts"),
    "cloud_row": ("int32", "n: row of the cloud arrays, -1 where there is none"),
    "cloud_depth": ("uint16", "m H W: depth at the sensor's resolution, 0 at the person"),
    "cloud_intrinsics": ("float32", "m 3 3: camera of the cloud"),
}
"""Every array of a cache: its dtype and what it holds (n windows, m of them with a cloud)."""


VERIFIED = "verified.json"
"""Sizes and times of a cache's files when their checksums were last compared."""


def recipe_hash(recipe: Mapping[str, Any]) -> str:
    """A short name for a recipe: equal recipes have equal names."""
    return hashlib.sha256(json.dumps(recipe, sort_keys=True).encode()).hexdigest()[:12]


@dataclass(frozen=True)
class WindowCache:
    """A cache that is whole.

    Attributes:
        folder: where it lies.
        index: `name`, `recipe`, `fps`, `skeleton`, `dropped` (reason -> windows), `files` (sha256), `notes`
            (what speaks against the figures, if anything).
    """

    folder: Path
    index: dict[str, Any]

    @classmethod
    def open(cls, folder: Path) -> WindowCache:
        """Reads a cache and checks every file's sha256.

        Files that have not changed in size and time since they were last checked are not read again; without
        `verified.json` all are.

        Raises:
            SagError: it is missing, half written or damaged; the sentence names the file.
        """
        index = read_index(folder)
        _verify(folder, index["files"])
        return cls(folder, index)

    def __len__(self) -> int:
        return len(self.split)

    def __getattr__(self, name: str) -> np.ndarray:
        if name not in ARRAYS:
            raise AttributeError(name)
        array = np.load(self.folder / f"{name}.npy", mmap_mode="r", allow_pickle=False)
        object.__setattr__(self, name, array)
        return array

    @cached_property
    def fingerprint(self) -> str:
        """A short name for the exact bytes of this cache."""
        return recipe_hash(self.index["files"])

    def rows(self, split: str) -> np.ndarray:
        """Places of the windows of one split."""
        return np.flatnonzero(self.split == SPLITS.index(split))


def _verify(folder: Path, files: Mapping[str, str]) -> None:
    """Compares sizes and times with those of the last full check, and checksums where they differ."""
    stamps = {name: _stamp(folder / name) for name in files}
    if None not in stamps.values() and _last_stamps(folder) == stamps:
        return
    for name, expected in files.items():
        if stamps[name] is None or sha256_of(folder / name) != expected:
            raise SagError(f"{folder / name} is damaged or missing; delete {folder} to have it rebuilt")
    with contextlib.suppress(OSError):  # a cache that may only be read is checked in full each time
        write_json(folder / VERIFIED, stamps)


def _stamp(path: Path) -> list[int] | None:
    """Size and time of a file, if it is there."""
    if not path.is_file():
        return None
    found = path.stat()
    return [found.st_size, found.st_mtime_ns]


def _last_stamps(folder: Path) -> object:
    try:
        return json.loads((folder / VERIFIED).read_text())
    except (OSError, ValueError):
        return None


def write_cache(
    folder: Path, arrays: Mapping[str, np.ndarray], index: Mapping[str, Any], extra: Mapping[str, bytes] = {}
) -> WindowCache:
    """Writes a cache whole or not at all: temporary name, sync, rename.

    Args:
        folder: final place.
        arrays: one for each name of `ARRAYS`.
        index: see `WindowCache`; `files` is added here.
        extra: further files by name, such as known geometry.

    Raises:
        SagError: an array is missing or of another dtype, or the disk has no room.
    """
    for name, (dtype, meaning) in ARRAYS.items():
        if name not in arrays or arrays[name].dtype != dtype:
            found = arrays[name].dtype if name in arrays else "nothing"
            raise SagError(f"cache array {name} must be {dtype} ({meaning}), found {found}")
    partial = folder.with_name(f"{folder.name}.partial-{os.getpid()}")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    try:
        needed = sum(a.nbytes for a in arrays.values())
        if needed > shutil.disk_usage(partial).free:
            raise SagError(f"{folder.parent} has less than the {needed / 1e9:.1f} GB free that the cache needs")
        for name in ARRAYS:
            np.save(partial / f"{name}.npy", np.ascontiguousarray(arrays[name]), allow_pickle=False)
        for name, content in extra.items():
            (partial / name).parent.mkdir(parents=True, exist_ok=True)
            (partial / name).write_bytes(content)
        written = sorted(p for p in partial.rglob("*") if p.is_file())
        files = {str(p.relative_to(partial)): sha256_of(p) for p in written}
        write_index(partial, {**index, "files": files})
        shutil.rmtree(folder, ignore_errors=True)
        partial.rename(folder)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return WindowCache.open(folder)


def open_or_build(
    parent: Path, name: str, recipe: Mapping[str, Any], build: Callable[[Path], WindowCache]
) -> WindowCache:
    """The cache of a recipe, built when it is not there and rebuilt when it is damaged (said aloud).

    Args:
        parent: folder that holds the caches.
        name: data set.
        recipe: everything that decides the bytes.
        build: writes the cache to the folder it is given.
    """
    folder = parent / f"{name}-{recipe_hash(recipe)}"
    if folder.exists():
        try:
            return WindowCache.open(folder)
        except SagError as error:
            print(f"rebuilding: {error}", flush=True)
    return build(folder)
