"""Claim: the Fréchet distance is faster than its peers', and right where sets are smaller than their dimension."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import torch
from torch import Tensor

from benchmarks.claim import Claim, Say, faster
from benchmarks.known_sets import known_pairs
from benchmarks.paired import Work, paired
from benchmarks.peers import Distance, frechet_peers
from sag.metrics.frechet import Gaussian

LEAST: dict[str, float | None] = {"torchmetrics": 3, "pytorch-fid": 40, "clean-fid": None}
"""How many times faster than each peer; clean-fid has the formula of pytorch-fid and is only told."""

SHARE_OF_ERROR = 0.25
"""The most that our error may be of torchmetrics'."""

_ROUNDING = 1e-14
"""Shares of the spread below which an error is the rounding of the sets themselves."""


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Speed on sets of full and of lower rank, then the errors where the truth is known."""
    dimension, rounds = (64, 1) if quick else (1000, 5)
    peers = frechet_peers()
    for members in (3 * dimension, 3 * dimension // 10):
        say(f"Fréchet distance of sets of {members} in {dimension} dimensions")
        yield from _speed(peers, dimension, members, rounds)
    say("Fréchet distance where the truth is known")
    yield from _error(peers, dimension, 3 * dimension // 10, seeds=1 if quick else 3)


def _speed(peers: Mapping[str, Distance], dimension: int, members: int, rounds: int) -> Iterator[Claim]:
    """One distance to a real side whose root is there, as every row of an evaluation after the first has it."""
    real, generated = (Gaussian.of(_features(members, dimension, seed)) for seed in (0, 1))
    moments = (real.mean, real.covariance, generated.mean, generated.covariance)
    real.root  # noqa: B018  computes it
    ours = Work(lambda _: float(real.distance(Gaussian(generated.mean, generated.covariance))))
    theirs = {name: _work(distance, moments) for name, distance in peers.items()}
    what = f"Fréchet distance, {dimension}-d, sets of {members}, the real root known"
    timed = paired(ours, theirs, rounds)
    for name, least in LEAST.items():
        if name in timed:
            yield faster(what, name, timed[name], least, _values(timed[name].found[-1]))
        else:
            yield Claim(what, name, float("nan"), least, "", "", note=f"{name} is not installed: run make bench")


def _work(distance: Distance, moments: tuple[Tensor, Tensor, Tensor, Tensor]) -> Work:
    return Work(lambda _: distance(*moments))


def _error(peers: Mapping[str, Distance], dimension: int, rank: int, seeds: int) -> Iterator[Claim]:
    """The pair of sets on which we are worst beside torchmetrics, and everybody's distance of identical sets."""
    shares, ours, theirs = [], [], []
    identical: dict[str, float] = {}
    for seed in range(seeds):
        for name, real, generated, truth in known_pairs(dimension, rank, seed):
            a, b = Gaussian.of(real), Gaussian.of(generated)
            spread = float(a.covariance.trace() + b.covariance.trace())
            moments = (a.mean, a.covariance, b.mean, b.covariance)
            ours.append(abs(float(a.distance(b)) - truth) / spread)
            theirs.append(abs(peers["torchmetrics"](*moments) - truth) / spread)
            shares.append(ours[-1] / max(theirs[-1], _ROUNDING))
            if name == "identical" and seed == 0:
                found = {"ours": float(a.distance(b)), **{peer: f(*moments) for peer, f in peers.items()}}
                identical = {peer: distance / spread for peer, distance in found.items()}
    yield Claim(
        f"error on {len(shares)} pairs of sets of known distance, rank {rank} of {dimension}",
        "torchmetrics",
        found=max(shares),
        asked=SHARE_OF_ERROR,
        ours=f"{max(ours):.2g}",
        theirs=f"{max(theirs):.2g}",
        at_least=False,
        spread=(min(shares), max(shares)),
        rounds=len(shares),
        unit=" of theirs",
        note="errors as a share of both sets' variance, the largest of all pairs; the share judged is the worst pair's",
    )
    said = ", ".join(f"{peer} {distance:.1e}" for peer, distance in identical.items())
    yield Claim(
        f"distance of identical sets, rank {rank} of {dimension}",
        "the truth, 0",
        found=abs(identical["ours"]),
        asked=1e-12,
        ours=f"{identical['ours']:.1e}",
        theirs=f"{min(identical.values()):.1e}",
        at_least=False,
        unit="",
        note=f"shares of both sets' variance: {said}",
    )


def _features(members: int, dimension: int, seed: int) -> Tensor:
    """Features on axes turned at random, with deviations that fall by 1,000 from the first to the last."""
    generator = torch.Generator().manual_seed(seed)
    turn = torch.linalg.qr(torch.randn(dimension, dimension, generator=generator, dtype=torch.float64)).Q
    scores = torch.randn(members, dimension, generator=generator, dtype=torch.float64)
    return scores * torch.logspace(0, -3, dimension, dtype=torch.float64) @ turn.T


def _values(found: tuple[float, float]) -> str:
    return f"distances {found[0]:.9g} and {found[1]:.9g}"
