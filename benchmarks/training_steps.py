"""Claim: a training step costs little more than arithmetic demands, and its rewrites pay beside the plain reading."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from statistics import median

import torch

from benchmarks.claim import Claim, Say, faster
from benchmarks.flops import flops
from benchmarks.paired import Work, paired
from benchmarks.training_step import Step, both_steps, windows
from sag.components import Network
from sag.types import Batch, Condition, Motion

LEAST = {1: 1.7, 5: 2.4}
"""How many times faster than the plain reading a whole step is, by critic steps."""

CRITICS_LEAST, CRITICS_SHARE = 2.3, 0.35
"""The same of the critics' step alone, and the most that its arithmetic may be of the plain reading's."""

ACHIEVED = 0.6
"""The least that a step's arithmetic a second may be of a product of matrices'."""

PEER = "the plain reading of the paper"

SQUARE = 2048
"""Rows of the float32 matrices whose product is the yardstick."""


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Whole steps, the critics alone, and arithmetic a second, at the paper's sizes."""
    torch.set_flush_denormal(True)
    network, size, count = (Network(width=0.05), (36, 64), 2) if quick else (Network(), (288, 512), 4)
    rounds = 1 if quick else 5
    batch = windows(count, size)
    what = f"{{}}, {size[0]}x{size[1]}, {count} windows"
    for critic_steps, least in ({1: LEAST[1]} if quick else LEAST).items():
        say(f"a whole training step with {critic_steps} critic steps beside the plain reading")
        ours, plain = both_steps(network, size, critic_steps, batch.motion)
        mine, theirs = (Work(partial(_whole, step, batch)) for step in (ours, plain))
        timed = paired(mine, {PEER: theirs}, rounds)[PEER]
        share = flops(mine) / flops(theirs)
        note = f"MDPC with its optimisers; {share:.2f} of the plain reading's arithmetic"
        yield faster(what.format(f"whole step, {critic_steps} critic steps"), PEER, timed, least, note)
    say("the critics' step")
    yield from _critics(ours, plain, batch, what.format("step of all critics with penalty"), rounds)
    say("arithmetic a second")
    yield _achieved(both_steps(network, size, 1, batch.motion)[0], batch, what.format("whole step"), rounds)


def _whole(step: Step, batch: Batch, number: int) -> None:
    step.whole(batch)


def _critics_alone(step: Step, batch: Batch, fake: Motion, condition: Condition, number: int) -> None:
    step.critics_alone(batch, fake, condition)


def _critics(ours: Step, plain: Step, batch: Batch, what: str, rounds: int) -> Iterator[Claim]:
    """Time and arithmetic of the critics' step, the feature and the generated motions given."""
    with torch.no_grad():
        condition = ours.sampler.condition(batch.scene, batch.motion)
        fake, _ = ours.generate(condition, batch.motion)
    mine, theirs = (Work(partial(_critics_alone, step, batch, fake, condition)) for step in (ours, plain))
    timed = paired(mine, {PEER: theirs}, rounds)[PEER]
    yield faster(what, PEER, timed, CRITICS_LEAST, "trajectory, pose, projection and context; optimiser included")
    done = [flops(mine), flops(theirs)]
    yield Claim(
        f"arithmetic of the {what}",
        PEER,
        found=done[0] / done[1],
        asked=CRITICS_SHARE,
        ours=f"{done[0] / 1e9:.3g} GFLOP",
        theirs=f"{done[1] / 1e9:.3g} GFLOP",
        at_least=False,
        unit=" of theirs",
    )


def _achieved(step: Step, batch: Batch, what: str, rounds: int) -> Claim:
    """Arithmetic a second of a whole step beside that of a product of two large matrices in the same rounds."""
    done = flops(Work(partial(_whole, step, batch)))
    a, b = torch.randn(2, SQUARE, SQUARE)
    product = Work(lambda _: [torch.mm(a, b) for _ in range(4)], 4 * 2 * SQUARE**3)
    timed = paired(Work(partial(_whole, step, batch), done), {"sgemm": product}, rounds)["sgemm"]
    return Claim(
        f"arithmetic a second of a {what}",
        "the same run's sgemm",
        found=timed.ratio,
        asked=ACHIEVED,
        ours=f"{1e-9 / median(timed.ours):.3g} GFLOP/s",
        theirs=f"{1e-9 / median(timed.theirs):.3g} GFLOP/s",
        spread=(min(timed.ratios), max(timed.ratios)),
        rounds=rounds,
        unit=" of it",
        note=f"sgemm is torch.mm of float32 matrices of {SQUARE} x {SQUARE}; convolutions and products alone count as "
        "arithmetic, all else as time",
    )
