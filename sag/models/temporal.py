"""Convolution over time as one product of matrices, with channels innermost in memory (row Conv of Tables 6 to 11).

Tensors are (..., c, t) to whoever calls, as torch has them, but lie in memory as (..., t, c): then each window of three
frames is a row of a matrix, no layout is ever changed, and the convolution's derivatives are products of matrices too.
The same holds for weights, whose shapes and names are those of `torch.nn.Conv1d`.
"""

from __future__ import annotations

from typing import Any

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.batch_norm import BatchNorm1d

TAPS = 3
"""Frames that a kernel covers."""


def frames_after(frames: int, stride: int, padding: int) -> int:
    """How many places a kernel of three frames has."""
    return (frames + 2 * padding - TAPS) // stride + 1


def windows(x: Float[Tensor, "*n t c"], stride: int, padding: int) -> Float[Tensor, "*n s k"]:
    """The three frames under the kernel at each of its places, side by side in one row; zeros beyond the ends."""
    return _Windows.apply(x, stride, padding)


def _under_tap(tap: int, frames: int, stride: int, padding: int) -> tuple[slice, slice]:
    """Places at which a tap meets a frame that exists, and those frames."""
    first = max(0, -(-(padding - tap) // stride))
    stop = min(frames_after(frames, stride, padding), (frames - 1 + padding - tap) // stride + 1)
    start = first * stride + tap - padding
    return slice(first, stop), slice(start, start + (stop - first - 1) * stride + 1, stride)


class _Windows(torch.autograd.Function):
    """Copies frames into windows; its derivative adds windows up, whose derivative copies again."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, stride: int, padding: int) -> Tensor:
        ctx.frames, ctx.stride, ctx.padding = x.shape[-2], stride, padding
        *rest, frames, channels = x.shape
        made = x.new_empty(*rest, frames_after(frames, stride, padding), TAPS, channels)
        for tap in range(TAPS):
            places, met = _under_tap(tap, frames, stride, padding)
            made[..., places, tap, :] = x[..., met, :]
            made[..., : places.start, tap, :] = 0
            made[..., places.stop :, tap, :] = 0
        return made.flatten(-2)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None, None]:  # type: ignore[override]
        return _SummedWindows.apply(gradient, ctx.frames, ctx.stride, ctx.padding), None, None


class _SummedWindows(torch.autograd.Function):
    """Adds up what the windows say of each frame: the transpose of `_Windows`."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, frames: int, stride: int, padding: int) -> Tensor:
        ctx.stride, ctx.padding = stride, padding
        taps = x.unflatten(-1, (TAPS, -1))
        made = x.new_zeros(*x.shape[:-2], frames, taps.shape[-1])
        for tap in range(TAPS):
            places, met = _under_tap(tap, frames, stride, padding)
            made[..., met, :] += taps[..., places, tap, :]
        return made

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None, None, None]:  # type: ignore[override]
        return _Windows.apply(gradient, ctx.stride, ctx.padding), None, None, None


def told(
    y: Float[Tensor, "n s d"], taps: Float[Tensor, "n 3 d"], frames: int, stride: int, padding: int
) -> Float[Tensor, "n s d"]:
    """Adds what a value that is the same in all frames brings: the taps that meet a frame, at each place.

    Args:
        y: the convolution of the rest.
        taps: what each tap makes of the value.
        frames: before the convolution.
        stride: of the convolution.
        padding: of the convolution.
    """
    ones = y.new_ones(1, frames, 1)
    met = windows(ones, stride, padding).expand(len(y), -1, -1)
    return torch.baddbmm(y, met, taps)


class TemporalConv(nn.Conv1d):
    """`torch.nn.Conv1d` with three taps, and with a condition that is the same in all frames."""

    def __init__(self, in_channels: int, out_channels: int, stride: int = 1, padding: int = 1) -> None:
        super().__init__(in_channels, out_channels, TAPS, stride, padding)
        self.weight = nn.Parameter(self.weight.detach().permute(2, 1, 0).contiguous().permute(2, 1, 0))

    def forward(  # type: ignore[override]
        self, x: Float[Tensor, "b c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b d s"]:
        """Convolves, as if the condition's channels stood behind the others in every frame."""
        stride, padding, own = self.stride[0], int(self.padding[0]), x.shape[1]
        weight = self.weight.permute(2, 1, 0)
        seen = windows(x.transpose(1, 2), stride, padding)
        y = F.linear(seen, weight[:, :own].flatten(0, 1).t(), self.bias)
        if condition is not None:
            taps = torch.matmul(condition, weight[:, own:]).transpose(0, 1)
            y = told(y, taps, x.shape[-1], stride, padding)
        return y.transpose(1, 2)


class TemporalBlock(nn.Sequential):
    """Activation, convolution and what follows, with a condition for the convolution."""

    def forward(  # type: ignore[override]
        self, x: Float[Tensor, "b c t"], condition: Float[Tensor, "b e"] | None = None
    ) -> Float[Tensor, "b d s"]:
        """Runs the layers in order; the condition goes through the activation too."""
        activation, conv, *rest = self
        x = conv(activation(x), None if condition is None else activation(condition))
        for layer in rest:
            x = layer(x)
        return x


class Doubling(nn.Module):
    """Repeats every frame: nearest-neighbour upsampling by 2 over time."""

    def forward(self, x: Float[Tensor, "*n c t"]) -> Float[Tensor, "*n c s"]:
        """Twice as many frames."""
        by_frame = x.transpose(-1, -2)
        twice = by_frame[..., None, :].expand(*by_frame.shape[:-1], 2, by_frame.shape[-1])
        return twice.flatten(-3, -2).transpose(-1, -2)


class LayerNorm(nn.GroupNorm):
    """Normalises channels and frames of a node together: `torch.nn.GroupNorm` with one group."""

    def __init__(self, channels: int) -> None:
        super().__init__(1, channels)

    def forward(self, x: Float[Tensor, "n c t"]) -> Float[Tensor, "n c t"]:
        """Each of the n apart."""
        n, channels, frames = x.shape
        rows = x.transpose(1, 2).reshape(n, frames * channels)
        normal = F.layer_norm(rows, rows.shape[1:], self.weight.repeat(frames), self.bias.repeat(frames), self.eps)
        return normal.view(n, frames, channels).transpose(1, 2)


class BatchNorm(BatchNorm1d):
    """Normalises each channel over all nodes and frames of the batch: `torch.nn.BatchNorm1d`, channels innermost."""

    def forward(self, x: Float[Tensor, "n c t"]) -> Float[Tensor, "n c t"]:
        """All of the n together."""
        n, channels, frames = x.shape
        rows = x.transpose(1, 2).reshape(n * frames, channels)
        return super().forward(rows).view(n, frames, channels).transpose(1, 2)
