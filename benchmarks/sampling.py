"""Claim: one pass of both generators takes a small share of what a diffusion model's steps take."""

from __future__ import annotations

from collections.abc import Iterator

import torch
from torch import Tensor, nn

from benchmarks.claim import Claim, Say, faster
from benchmarks.paired import Work, paired
from benchmarks.training_step import windows
from sag.components import Components, Network, build_encoder, build_generator
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.types import FRAMES, Batch

LEAST = {1: 100, 64: 400}
"""How many times faster than the denoiser both generators are, by motions at once."""

ENCODED_LEAST = 10
"""The same for one motion with the scene encoder, which a denoiser of motion alone does not have."""

STEPS = 50
"""Denoising steps of a motion."""

PEER = f"{STEPS} steps of a denoiser of MDM's size"


class Denoiser(nn.Module):
    """A transformer of the size of MDM's (Tevet et al., ICLR 2023): 8 layers, 512 wide, 4 heads, 1024 between.

    Args:
        numbers: of a frame.
        width: of a token.
        layers: of the transformer.
    """

    def __init__(self, numbers: int, width: int = 512, layers: int = 8) -> None:
        super().__init__()
        layer = nn.TransformerEncoderLayer(width, 4, 2 * width, activation="gelu", batch_first=True)
        self.inward = nn.Linear(numbers, width)
        self.layers = nn.TransformerEncoder(layer, layers, enable_nested_tensor=False)
        self.outward = nn.Linear(width, numbers)

    def forward(self, noisy: Tensor, told: Tensor) -> Tensor:
        """One step for motions (b, t, numbers), with a token (b, width) of time and condition before them."""
        tokens = torch.cat([told[:, None], self.inward(noisy)], dim=1)
        return self.outward(self.layers(tokens)[:, 1:])


def claims(quick: bool, say: Say) -> Iterator[Claim]:
    """Generators alone for one motion and many, then one motion from its picture."""
    network, size, rounds = (Network(width=0.1), (72, 128), 1) if quick else (Network(), (288, 512), 7)
    joints = len(GTA_IM_19.joints)
    torch.manual_seed(0)
    scale = MotionScale(joints, GTA_IM_19.root_index, network.units)
    generator = build_generator(Components(), network, GTA_IM_19, scale)
    sampler = Sampler(build_encoder(network), generator, scale).eval()
    denoiser = Denoiser(3 * joints, *((32, 1) if quick else ())).eval()
    for count, least in LEAST.items():
        say(f"sampling {count} motions beside a denoiser")
        peer = {PEER: _denoising(denoiser, count)}
        timed = paired(_generating(sampler, windows(count, (36, 64))), peer, rounds)[PEER]
        note = "both generators, the scene feature given; one of the denoiser's equal steps is timed and taken 50 times"
        yield faster(f"sampling one motion of {count} at once, width {network.width:g}", PEER, timed, least, note)
    say("sampling from a picture beside a denoiser")
    timed = paired(_from_picture(sampler, windows(1, size)), {PEER: _denoising(denoiser, 1)}, rounds)[PEER]
    yield faster(f"sampling one motion from its picture, {size[0]}x{size[1]}", PEER, timed, ENCODED_LEAST)


def _denoising(denoiser: Denoiser, count: int) -> Work:
    noisy = torch.randn(count, FRAMES, denoiser.inward.in_features)
    told = torch.randn(count, denoiser.outward.in_features)

    def run(number: int) -> Tensor:
        with torch.inference_mode():
            return denoiser(noisy, told)

    return Work(run, count / STEPS)


def _generating(sampler: Sampler, batch: Batch) -> Work:
    with torch.inference_mode():
        condition = sampler.condition(batch.scene, batch.motion)

    def run(number: int) -> Tensor:
        with torch.inference_mode():
            noise = sampler.generator.noise(len(batch))
            return sampler.generator(condition, batch.motion, noise).joints

    return Work(run, len(batch))


def _from_picture(sampler: Sampler, batch: Batch) -> Work:
    def run(number: int) -> Tensor:
        with torch.inference_mode():
            return sampler(batch.scene, batch.motion).joints

    return Work(run, len(batch))
