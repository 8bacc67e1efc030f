"""Batch norm over the whole batch, on however many processes its windows are."""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.modules.batchnorm import _BatchNorm

from sag.processes import processes, stacked


class OverProcesses(_BatchNorm):
    """What makes a batch norm of PyTorch see the windows of all processes while it trains.

    `torch.nn.SyncBatchNorm` does not do here: it has no form for processors, and no second derivative, which the
    gradient penalty takes through every critic. Alone, and wherever nothing is trained, it is PyTorch's own.

    Attributes:
        together: whether processes normalise by their common statistics, or each by its own.
    """

    together = True

    def forward(self, x: Float[Tensor, "n c *any"]) -> Float[Tensor, "n c *any"]:
        """Normalises each channel."""
        if self.training and self.together and processes() > 1:
            return self._over_processes(x)
        return super().forward(x)

    def _over_processes(self, x: Tensor) -> Tensor:
        """As one process normalises, given that all have equally much."""
        wide = x.float() if x.dtype in (torch.float16, torch.bfloat16) else x
        axes = [axis for axis in range(x.dim()) if axis != 1]
        over = (1, -1, *[1] * (x.dim() - 2))
        own_mean = wide.mean(axes)
        own_variance = (wide - own_mean.view(over)).square().mean(axes)
        means, variances = stacked(torch.stack([own_mean, own_variance])).unbind(1)
        mean = means.mean(0)
        variance = (variances + (means - mean).square()).mean(0)
        self._keep(mean, variance, processes() * x.numel() // x.shape[1])
        normal = (wide - mean.view(over)) * (variance + self.eps).rsqrt().view(over)
        if self.affine:
            normal = normal * self.weight.view(over) + self.bias.view(over)
        return normal.to(x.dtype)

    @torch.no_grad()
    def _keep(self, mean: Tensor, variance: Tensor, count: int) -> None:
        """Takes statistics over so many values of each channel into those that are used after training."""
        assert self.running_mean is not None and self.running_var is not None and self.num_batches_tracked is not None
        share = self.momentum or 1.0
        self.running_mean.lerp_(mean.to(self.running_mean), share)
        self.running_var.lerp_((variance * (count / (count - 1))).to(self.running_var), share)
        self.num_batches_tracked.add_(1)


class BatchNorm1d(OverProcesses, nn.BatchNorm1d):
    """`torch.nn.BatchNorm1d` over the windows of all processes."""


class BatchNorm2d(OverProcesses, nn.BatchNorm2d):
    """`torch.nn.BatchNorm2d` over the windows of all processes."""
