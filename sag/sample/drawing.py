"""Motions of a window, each from a state of chance of its own."""

from __future__ import annotations

import argparse

import torch
from jaxtyping import Float
from torch import Tensor

from sag.methods.base import Method
from sag.methods.sliding import sample_long
from sag.types import FRAMES, Batch

LEAST_FRAMES = 2
"""Of a motion: the given one and another."""

STRIDE = 1_000_003
"""From the seed of one sample to the next one's; a prime, so that neighbouring seeds share none."""


@torch.no_grad()
def drawn(method: Method, batch: Batch, asked: argparse.Namespace) -> Float[Tensor, "k t j 3"]:
    """The motions of one window, metres, camera frame of frame 0; the k-th is the same however many are asked for.

    Args:
        method: what draws.
        batch: the window alone.
        asked: `samples`, `frames`, `overlap` and `seed`; fewer frames than a window has are its first ones.
    """
    on = batch.to(method.device)
    motions = []
    for sample in range(asked.samples):
        generator = torch.Generator(method.device).manual_seed(asked.seed + STRIDE * sample)
        whole = sample_long(method, on, max(asked.frames, FRAMES), asked.overlap, generator)
        motions.append(whole[0, : asked.frames].float().cpu())
    return torch.stack(motions)
