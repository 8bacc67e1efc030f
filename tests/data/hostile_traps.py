"""Damage to a recording's pickles and pictures: gadgets, bombs, and what is not what it says."""

from __future__ import annotations

import builtins
import os
import pickle
import shutil
import struct
import subprocess
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from gta_im_files import COLUMNS, ROWS
from hostile_files import COLOUR, PICKLE, Damage, canary
from PIL import Image


class Calls:
    """Pickles as a call of something."""

    def __init__(self, function: Callable[..., object], *arguments: object) -> None:
        self.call = (function, arguments)

    def __reduce__(self) -> object:
        return self.call


# --- pickles ---


def pickled(name: str, content: Callable[[Path], object] | object) -> Damage:
    def damage(folder: Path) -> None:
        made = content(folder) if callable(content) else content
        (folder / name).write_bytes(made if isinstance(made, bytes) else pickle.dumps(made))

    return damage


def clips(**changes: object) -> Damage:
    """Other clip planes in frame 3."""

    def damage(folder: Path) -> None:
        frames = pickle.loads((folder / PICKLE).read_bytes())
        frames[3].update(changes)
        (folder / PICKLE).write_bytes(pickle.dumps(frames))

    return damage


def gadgets() -> dict[str, Callable[[Path], object]]:
    """Ten ways to have a pickle run something."""
    return {
        "system": lambda f: Calls(os.system, f"touch {canary(f)}"),
        "popen": lambda f: Calls(subprocess.Popen, ["touch", str(canary(f))]),
        "eval": lambda f: Calls(builtins.eval, f"open({str(canary(f))!r}, 'w')"),
        "exec": lambda f: Calls(builtins.exec, f"open({str(canary(f))!r}, 'w')"),
        "open": lambda f: Calls(builtins.open, str(canary(f)), "w"),
        "mkdir_inside": lambda f: [{"cam_near_clip": 0.1, "more": [Calls(os.mkdir, str(canary(f)))]}],
        "copytree": lambda f: Calls(shutil.copytree, str(f), str(canary(f))),
        "by_line": lambda f: b"cposix\nsystem\n(S'touch " + str(canary(f)).encode() + b"'\ntR.",
        "by_instance": lambda f: b"(S'touch " + str(canary(f)).encode() + b"'\niposix\nsystem\n.",
        "by_numpy": lambda f: b"\x80\x04\x8c\x05numpy\x8c\x0ef2py.os.system\x93\x8c\x04true\x85R.",
    }


FAR_MEMO = b"\x80\x02]r" + struct.pack("<I", 0x7FFFFFF0) + b"."
"""A list that is remembered at place two thousand million."""

LONG_BYTES = b"\x80\x05\x96" + struct.pack("<Q", 1 << 34) + b"ab."
"""A byte array that claims 16 GB."""


def copies() -> bytes:
    """One megabyte of content that becomes an array ten thousand times."""
    content = b"\x80\x05B" + struct.pack("<I", 1 << 20) + bytes(1 << 20) + b"q\x000"
    dtype = b"cnumpy\ndtype\n(X\x02\x00\x00\x00u1K\x00K\x01tR"
    call = b"cnumpy._core.numeric\n_frombuffer\n(h\x00" + dtype + b"J\x00\x00\x10\x00\x85X\x01\x00\x00\x00CtR"
    return content + b"](" + 10_000 * call + b"e."


def endless_key() -> bytes:
    """A dictionary whose key is a nest of shared tuples, 2**60 of them to hash."""
    return b"\x80\x02}K\x01" + 60 * b"2\x86" + b"K\x00s."


ORDERED, DTYPE, ARRAY = (
    b"ccollections\nOrderedDict\n",
    b"cnumpy\ndtype\n",
    b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85U\x01b\x87R",
)
"""Names in protocol 2, and an array without a state."""


def ordered_copies(pairs: int = 2000, copies: int = 20_000) -> bytes:
    """A list of pairs that becomes an ordered dictionary again and again."""
    numbered = b"".join(b"J" + struct.pack("<i", number) + b"N\x86" for number in range(pairs))
    return b"\x80\x02](" + numbered + b"eq\x000" + ORDERED + b"q\x010](" + copies * b"h\x01h\x00\x85R" + b"e."


def ordered_states() -> bytes:
    """Ordered dictionaries that all take the attributes of a large dictionary."""
    named = b"".join(b"U\x05" + f"{number:05d}".encode() + b"N" for number in range(2000))
    one = b"h\x01)Rh\x00b"
    return b"\x80\x02}(" + named + b"uq\x000" + ORDERED + b"q\x010](" + 20_000 * one + b"e."


def swellings() -> dict[str, bytes]:
    """Pickles that are small and would take much memory, or much time."""
    shared = b"K\x01\x85q\x00" + b"".join(bytes([104, i, 134, 113, i + 1]) for i in range(40))
    many = struct.pack("<i", 10**8)
    long_key = b"(" + 5000 * b"K\x01" + b"tq\x000}("
    return {
        "ordered_key": b"\x80\x02" + ORDERED + b"]" + shared + b"K\x01\x86a\x85R.",
        "ordered_copies": ordered_copies(),
        "ordered_states": ordered_states(),
        "texts_of_no_length": b"\x80\x02"
        + ARRAY
        + b"(K\x01J"
        + many
        + b"\x85"
        + DTYPE
        + b"U\x02U0K\x00K\x01\x87R\x89U\x00tb.",
        "other_call": b"\x80\x02" + DTYPE + b"q\x00(N}U\x05_call" + ORDERED + b"stb0h\x00)R.",
        "long_key": b"\x80\x02" + long_key + 20_000 * b"h\x00N" + b"u.",
        "long_number": b"\x80\x02\x8b"
        + struct.pack("<i", 500_000)
        + 500_000 * b"\x01"
        + b"q\x000}("
        + 50_000 * b"h\x00N"
        + b"u.",
        "long_complex": b"\x80\x02c__builtin__\ncomplex\nU\x01" + b"1\x85R.",
        "empty_lists": b"\x80\x02](" + (1 << 19) * b"]" + b"e.",
        "empty_dictionaries": b"\x80\x02](" + (1 << 19) * b"}" + b"e.",
        "marks": b"\x80\x02" + (1 << 19) * b"(" + b".",
        "remembered": b"\x80\x04N" + (1 << 19) * b"\x94" + b".",
        "long_name": b"\x80\x02c" + 1000 * b"os." + b"\n" + 100_000 * b"x" + b"\n.",
    }


# --- pictures ---


def png_of(columns: int, rows: int, parts: bytes = b"") -> bytes:
    """A PNG that has a header and hardly more."""
    header = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", header) + parts + part(b"IEND", b"")


def part(name: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def text_bomb() -> bytes:
    """A small text in a PNG that unpacks to 64 MB."""
    return png_of(COLUMNS, ROWS, part(b"zTXt", b"a\x00\x00" + zlib.compress(bytes(64 << 20), 1)))


def picture(name: str, image: Image.Image) -> Damage:
    return lambda folder: image.save(folder / name, format="PNG" if name.endswith("png") else "JPEG")


def single(name: str, colour: tuple[int, int, int] = (0, 0, 0)) -> Damage:
    return picture(name, Image.new("RGB", (COLUMNS, ROWS), colour))


def cut_off(folder: Path) -> None:
    """The lower third of the picture is grey."""
    with Image.open(folder / COLOUR) as whole:
        image = np.array(whole)
    image[2 * ROWS // 3 :] = 128
    Image.fromarray(image).save(folder / COLOUR)


def as_gif(folder: Path) -> None:
    Image.new("RGB", (COLUMNS, ROWS)).save(folder / COLOUR, format="GIF")
