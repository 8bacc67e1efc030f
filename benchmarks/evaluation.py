"""Claim: a whole evaluation takes minutes."""

from __future__ import annotations

import time
from collections.abc import Iterator

import torch

from benchmarks.claim import Claim, Say, duration
from benchmarks.scenes import SIZES, furnished_room, motions, people
from sag.metrics import MotionFID, NonCollisionRatio
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

MOST = 300.0
"""Seconds of wall time on two cores, of which this one thread uses one."""

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
    for seed in range(count // BATCH):
        room = furnished_room(seed, SIZES[size])
        real, generated = motions(people(room, 2 * BATCH, seed), seed).split(BATCH)
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
        f"{clear.sample().tested:,} frames of non-collision at {size}, Motion FID of {count:,} motions",
        "no peer has both",
        found=spent,
        asked=MOST,
        ours=duration(spent),
        theirs="",
        at_least=False,
        unit=" s",
        note=f"wall time of one thread; encoders untrained; both sides counted: {distance:.3g} and {ratio:.3f}",
    )
