"""Features without motions: random numbers in the shape that `clip_features` has, few and cheap."""

import torch
from torch import Generator, Tensor

KEYS = [(16, 2), (16, 8), (16, 32)]
"""One encoder, and one clip length for each of short, mid and long."""


def gaussian_features(draw: Generator, motions: int, dimension: int = 4, shift: float = 0.0) -> dict:
    """One clip of each length for each motion, independent of each other."""
    return {key: torch.randn(motions, 1, dimension, generator=draw) + shift for key in KEYS}


def floats(values: dict[str, Tensor]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}
