"""Claim: running each start once gives Motion FID's features faster than clip by clip, and the same bits."""

from __future__ import annotations

from collections.abc import Iterator

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.claim import Claim, Say, faster
from benchmarks.paired import Pairing, Work, paired
from benchmarks.scenes import SIZES, furnished_room, motions, people
from sag.metrics.fid.clips import LENGTHS, ClipFeatures, clip_features
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import GENERATED

LEAST = 1.6
"""How many times faster than clip by clip: 224 frames a motion and encoder instead of 384."""

WIDTHS = {"quick": 0.128, "full-size": 1.0}
"""Encoders by the factor on their hidden sizes."""

ROOT = GTA_IM_19.root_index


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Speed and equality for quick and full-size encoders; training changes neither.

    Full-size encoders see as many motions at a time as a test step of the data modules has.
    """
    for name, width in {"tiny": 0.01}.items() if quick else WIDTHS.items():
        count, rounds = (4, 1) if quick else (64, 3) if width == 1 else (128, 7)
        say(f"Motion FID features of {count} motions by {name} encoders")
        torch.manual_seed(0)
        encoders = MotionEncoders("gta_im_19", width).eval()
        joints = motions(people(furnished_room(0, SIZES["288x512"]), count, seed=0), seed=0)
        pairing = _timed(encoders, joints, rounds)
        note = f"{count} motions at a time; fewer gain less, for the recurrence takes as many steps as clip by clip"
        yield faster(f"Motion FID features of a motion, {name} encoders", "clip by clip", pairing, LEAST, note)
        yield _equality(name, pairing, count)


def _timed(encoders: MotionEncoders, joints: Tensor, rounds: int) -> Pairing:
    ours = Work(lambda _: clip_features(encoders, joints, ROOT), len(joints))
    theirs = Work(lambda _: clip_by_clip(encoders, joints), len(joints))
    return paired(ours, {"clip by clip": theirs}, rounds)["clip by clip"]


@torch.no_grad()
def clip_by_clip(encoders: MotionEncoders, joints: Float[Tensor, "b t j 3"]) -> ClipFeatures:
    """The features by definition: the disjoint clips of each length, all of one length at once."""
    found: ClipFeatures = {}
    for length in LENGTHS:
        clips = joints[:, 1:].unflatten(1, (GENERATED // length, length)).flatten(0, 1)
        features = encoders.features(clips - clips[:, :1, ROOT : ROOT + 1], [length])
        found.update({key: x.unflatten(0, (len(joints), -1)) for key, x in features.items()})
    return found


def _equality(name: str, pairing: Pairing, count: int) -> Claim:
    """Numbers that are not the same to the bit, over all rounds, lengths and encoders."""
    differing, compared = 0, 0
    for ours, theirs in pairing.found:
        for key, features in theirs.items():
            differing += int((ours[key] != features).sum())
            compared += features.numel()
    return Claim(
        f"the same bits, {name} encoders",
        "clip by clip",
        found=differing,
        asked=0,
        ours=f"{compared:,} numbers",
        theirs="",
        at_least=False,
        rounds=len(pairing.found),
        unit=" differ",
        note=f"18 features of {count} motions",
    )
