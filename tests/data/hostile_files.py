"""Damage to the files of a recording, from a torn download to a trap: any file, archives, the folder itself."""

from __future__ import annotations

import gzip
import os
import shutil
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

NPZ, PICKLE, ROOM = "info_frames.npz", "info_frames.pickle", "realtimeinfo.gz"
COLOUR, DEPTH, IDS = "00000.jpg", "00000.png", "00000_id.png"

Damage = Callable[[Path], object]
"""Changes the folder of a recording; `elsewhere` and `canary` beside the root are at hand."""


def outside(folder: Path) -> Path:
    """The folder in which the data set's root lies."""
    return folder.parents[2]


def canary(folder: Path) -> Path:
    """What no pickle may bring to life."""
    return outside(folder) / "canary"


# --- any file ---


def truncated(name: str, share: float = 0.5) -> Damage:
    def damage(folder: Path) -> None:
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[: int(share * len(content))])

    return damage


def flipped(name: str, share: float) -> Damage:
    def damage(folder: Path) -> None:
        content = bytearray((folder / name).read_bytes())
        content[int(share * len(content))] ^= 0x41
        (folder / name).write_bytes(content)

    return damage


def replaced(name: str, content: bytes) -> Damage:
    return lambda folder: (folder / name).write_bytes(content)


def missing(name: str) -> Damage:
    return lambda folder: (folder / name).unlink()


def linked(name: str) -> Damage:
    def damage(folder: Path) -> None:
        shutil.move(folder / name, outside(folder) / "elsewhere")
        (folder / name).symlink_to(outside(folder) / "elsewhere")

    return damage


def pipe(name: str) -> Damage:
    def damage(folder: Path) -> None:
        (folder / name).unlink()
        os.mkfifo(folder / name)

    return damage


def a_folder(name: str) -> Damage:
    def damage(folder: Path) -> None:
        (folder / name).unlink()
        (folder / name).mkdir()

    return damage


# --- archives ---


def arrays(**changes: Callable[[np.ndarray], np.ndarray | None]) -> Damage:
    """Other arrays by name; nothing takes one away."""

    def damage(folder: Path) -> None:
        with np.load(folder / NPZ) as file:
            content = dict(file)
        for name, change in changes.items():
            content[name] = change(content[name])
        np.savez(folder / NPZ, **{name: array for name, array in content.items() if array is not None})

    return damage


def put(place: object, value: object) -> Callable[[np.ndarray], np.ndarray]:
    """The array with a value somewhere."""

    def change(array: np.ndarray) -> np.ndarray:
        array = array.copy()
        array[place] = value
        return array

    return change


def npy(shape: tuple[int, ...], content: bytes = b"") -> bytes:
    header = str({"descr": "<f8", "fortran_order": False, "shape": shape}).encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + content


def member(name: str, content: bytes) -> Damage:
    """Another content of one array of the archive."""

    def damage(folder: Path) -> None:
        with zipfile.ZipFile(folder / NPZ) as file:
            others = {n: file.read(n) for n in file.namelist() if n != f"{name}.npy"}
        with zipfile.ZipFile(folder / NPZ, "w", zipfile.ZIP_DEFLATED) as file:
            for other, kept in {**others, f"{name}.npy": content}.items():
                file.writestr(other, kept)

    return damage


def understated(method: int, size: int = 96 << 20) -> Damage:
    """An array that unpacks to much more than the size that is told of it."""

    def damage(folder: Path) -> None:
        array = npy((70, 3, 3), bytes(70 * 72))
        with zipfile.ZipFile(folder / NPZ, "w", method) as file:
            file.writestr("joints_3d_world.npy", npy((70, 21, 3), bytes(70 * 21 * 24)))
            file.writestr("world2cam_trans.npy", npy((70, 4, 4), bytes(70 * 128)))
            file.writestr("intrinsics.npy", array + bytes(size))
        content = (folder / NPZ).read_bytes()
        real, told = (struct.pack("<I", length) for length in (len(array) + size, len(array)))
        assert content.count(real) == 2  # before the array and in the directory
        (folder / NPZ).write_bytes(content.replace(real, told))

    return damage


def flipped_name(folder: Path) -> None:
    """A flipped bit in the directory at the archive's end."""
    content = bytearray((folder / NPZ).read_bytes())
    content[content.rindex(b"intrinsics")] ^= 1
    (folder / NPZ).write_bytes(content)


def twice(folder: Path) -> None:
    with zipfile.ZipFile(folder / NPZ, "a") as file:
        file.writestr("intrinsics.npy", file.read("intrinsics.npy"))


def climbing(folder: Path) -> None:
    """Arrays whose names climb out of the archive."""
    with zipfile.ZipFile(folder / NPZ) as file:
        content = {name: file.read(name) for name in file.namelist()}
    with zipfile.ZipFile(folder / NPZ, "w") as file:
        for name, kept in content.items():
            file.writestr(f"../../../{name}", kept)


# --- the recording ---


def linked_folder(folder: Path) -> None:
    shutil.move(folder, outside(folder) / "elsewhere")
    folder.symlink_to(outside(folder) / "elsewhere")


def arabic_digits(folder: Path) -> None:
    """Pictures numbered in digits of another script, which Python takes for numbers."""
    for name in (COLOUR, DEPTH, IDS):
        (folder / name).rename(folder / name.replace("0", "٠"))


def compressed(folder: Path) -> None:
    """A file that really is what its name says."""
    (folder / ROOM).write_bytes(gzip.compress((folder / ROOM).read_bytes()))
