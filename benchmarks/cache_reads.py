"""Claim: the window cache is read at memory speed, where the pictures of a data set must be decoded."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import numpy as np
from PIL import Image

from benchmarks.claim import Claim, Say, duration, faster
from benchmarks.paired import Pairing, Work, paired
from benchmarks.scenes import SIZES, furnished_room
from sag.data.base import Windows
from sag.data.cache import ARRAYS, WindowCache, write_cache
from sag.skeleton import GTA_IM_19
from sag.types import FRAMES

LEAST = 100
"""How many times faster a window's arrays are read than a native colour and depth picture."""

MOST = 2.5
"""How many times longer than a copy of the same bytes in memory."""

BATCH = 16
"""Windows of a batch, drawn anew in every round."""

NEEDED = ("joints", "image", "depth", "ids", "intrinsics", "world2cam")
"""Arrays that training reads of a window."""


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Reads of a window against decoding and against a copy in memory."""
    native, windows, rounds = ("288x512", 16, 1) if quick else ("1080p", 128, 21)
    with tempfile.TemporaryDirectory() as folder:
        say(f"a cache of {windows} windows and pictures at {native}")
        cache = _cache(Path(folder) / "cache", windows)
        _write_pictures(Path(folder), SIZES[native], 2)
        random = np.random.default_rng(0)
        batches = [random.permutation(windows)[:BATCH] for _ in range(rounds)]
        memory = {name: np.array(getattr(cache, name)) for name in NEEDED}
        say(f"reads of {BATCH} windows beside decoding and copying")
        peers = {"decoding": _decoding(Path(folder)), "copying": _copying(memory)}
        timed = paired(_reading(cache, batches), peers, rounds)
        whole = paired(_loading(cache, batches), {"decoding": _decoding(Path(folder))}, rounds)["decoding"]
    what = "a window's arrays from the cache, 288x512"
    yield faster(what, f"JPG and 24-bit PNG at {native}, decoded", timed["decoding"], LEAST)
    yield _slower(what, "a copy of the same bytes in memory", timed["copying"])
    note = "floats in [0, 1], metres and masks: what a training step takes"
    yield faster("a window of a batch, 288x512", f"JPG and 24-bit PNG at {native}, decoded", whole, None, note)


def _slower(what: str, peer: str, pairing: Pairing) -> Claim:
    """The claim to take at most this many times longer than a peer."""
    shares = [ours / theirs for ours, theirs in zip(pairing.ours, pairing.theirs)]
    return Claim(
        what,
        peer,
        found=median(shares),
        asked=MOST,
        ours=duration(median(pairing.ours)),
        theirs=duration(median(pairing.theirs)),
        at_least=False,
        spread=(min(shares), max(shares)),
        rounds=len(shares),
        note="times as long; the cache lies in the page cache, as after the first epoch",
    )


def _reading(cache: WindowCache, batches: list[np.ndarray]) -> Work:
    return Work(lambda number: [getattr(cache, name)[batches[number]] for name in NEEDED], BATCH)


def _loading(cache: WindowCache, batches: list[np.ndarray]) -> Work:
    windows = Windows(cache, "train", GTA_IM_19)
    return Work(lambda number: windows.__getitems__(batches[number].tolist()), BATCH)


def _copying(memory: dict[str, np.ndarray]) -> Work:
    """The first windows, which lie together, so that each array is one copy."""
    return Work(lambda number: [memory[name][:BATCH].copy() for name in NEEDED], BATCH)


def _decoding(folder: Path) -> Work:
    """Colour and depth of one frame, decoded and no more; its ids, a third picture, are not read."""

    def run(number: int) -> object:
        return [np.asarray(Image.open(folder / f"{number % 2}.{ending}")) for ending in ("jpg", "png")]

    return Work(run)


def _cache(folder: Path, windows: int) -> WindowCache:
    """A cache of random pictures at the paper's size."""
    random = np.random.default_rng(1)
    rows, columns = SIZES["288x512"]
    shapes = {
        "joints": (windows, FRAMES, len(GTA_IM_19.joints), 3),
        "image": (windows, rows, columns, 3),
        "depth": (windows, rows, columns),
        "ids": (windows, rows, columns),
        "intrinsics": (windows, 3, 3),
        "world2cam": (windows, 4, 4),
        "cloud_depth": (0, rows, columns),
        "cloud_intrinsics": (0, 3, 3),
    }
    arrays = {
        name: random.integers(0, 200, shapes.get(name, (windows,))).astype(dtype) for name, (dtype, _) in ARRAYS.items()
    }
    arrays["split"][:] = 0
    return write_cache(folder, arrays, {"name": "bench", "fps": 30, "dropped": {}, "notes": []})


def _write_pictures(folder: Path, size: tuple[int, int], count: int) -> None:
    """Pictures as GTA-IM stores them: colour with some grain, and depth in 24 bits, about 500 steps to the metre."""
    for number in range(count):
        depth = furnished_room(number, size).depth.numpy()
        grain = np.random.default_rng(number).normal(0, 4, (*size, 3))
        colour = (220 / (1 + depth[..., None] / [3, 4, 5]) + grain).clip(0, 255).astype(np.uint8)
        Image.fromarray(colour).save(folder / f"{number}.jpg", quality=95)
        codes = np.rint(500 * depth).astype(np.int64)
        packed = np.stack([codes >> 16 & 255, codes >> 8 & 255, codes & 255], axis=-1).astype(np.uint8)
        Image.fromarray(packed).save(folder / f"{number}.png")
