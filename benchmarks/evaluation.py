"""Claim: a whole evaluation takes minutes."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager

import torch

from benchmarks.claim import Claim, Say, duration
from benchmarks.scenes import SIZES, furnished_room, motions, people
from sag.metrics import MotionFID, NonCollisionRatio
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

MOST = 300.0
"""Seconds of wall time."""

CORES = 2
MOTIONS, FRAMES = 2000, 5
"""Motions on each side, and frames of each that are judged: 10,000."""

BATCH = 50
"""Motions of one room, a batch."""


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Wall time of both metrics from motions and depth maps to figures."""
    count, size = (2 * BATCH, "288x512") if quick else (MOTIONS, "1080p")
    say(f"the whole evaluation of {count} motions at {size}")
    torch.manual_seed(0)
    encoders = MotionEncoders("gta_im_19", width=0.01 if quick else 0.128).eval()
    fid = MotionFID(encoders, GTA_IM_19.root_index)
    clear = NonCollisionRatio(GTA_IM_19.bone_index, frames=FRAMES)
    spent = 0.0
    with _on_cores(CORES):
        for seed in range(count // BATCH):
            room = furnished_room(seed, SIZES[size])
            starts = people(room, 2 * BATCH, seed)
            real, generated = motions(starts, seed).split(BATCH)
            cloud = DepthMap(room.depth.expand(BATCH, -1, -1), room.intrinsics.expand(BATCH, 3, 3))
            begun = time.perf_counter()
            fid.update(real, real=True)
            fid.update(generated, real=False)
            clear.update(generated, cloud)
            spent += time.perf_counter() - begun
        begun = time.perf_counter()
        distance, ratio = fid.compute()["average"], clear.compute()["average"]
        spent += time.perf_counter() - begun
    yield Claim(
        f"{clear.sample().tested:,} frames of non-collision at {size}, Motion FID of {count:,} motions, {CORES} cores",
        "no peer has both",
        found=spent,
        asked=MOST,
        ours=duration(spent),
        theirs="",
        at_least=False,
        unit=" s",
        note=f"wall time; quick encoders, untrained; average {distance:.3g} and {ratio:.3f}; real side included",
    )


@contextmanager
def _on_cores(count: int) -> Iterator[None]:
    """Lets this process use so many cores, and where the system can say so no others."""
    before = torch.get_num_threads()
    cores = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None
    torch.set_num_threads(count)
    if cores:
        os.sched_setaffinity(0, set(sorted(cores)[:count]))
    try:
        yield
    finally:
        torch.set_num_threads(before)
        if cores:
            os.sched_setaffinity(0, cores)
