"""The kernel distance of two sets of features, which does not depend on how many they are."""

from __future__ import annotations

import torch
from jaxtyping import Float, Int
from torch import Tensor


def kernel_distance(
    a: Float[Tensor, "n d"],
    b: Float[Tensor, "m d"],
    index: tuple[Int[Tensor, " n"], Int[Tensor, " m"]] | None = None,
) -> Float[Tensor, ""]:
    """The unbiased squared maximum mean discrepancy under the cubic kernel k(x, y) = (x.y / d + 1)^3, in float64.

    mean of k(a_i, a_j) + mean of k(b_i, b_j) - 2 mean of k(a_i, b_j), each over pairs of different index

    (Gretton et al., 2012; the kernel of Binkowski et al., ICLR 2018.) Its mean over samples is the true value at any
    number of samples, so for two samples of one distribution it scatters around 0 and may be negative.

    Features that continue one thing are alike, on two sides as on one: pairs of them would bias the mean, downwards
    where they lie across the sides. An index names what a feature continues, and only features of different index are
    compared; two equal sets of equal indices are then at 0 whatever their number.

    Args:
        a: features of at least 2 indices.
        b: features of at least 2 indices.
        index: of the features of a and of b; without it all are of different ones. NaN where no pair is left.

    Example:
        >>> import torch
        >>> draw = torch.manual_seed(0)
        >>> a, b = torch.randn(500, 8, generator=draw), torch.randn(500, 8, generator=draw)
        >>> abs(float(kernel_distance(a, b))) < 0.1, float(kernel_distance(a, b + 1)) > 1
        (True, True)
        >>> same = torch.arange(500), torch.arange(500)
        >>> abs(float(kernel_distance(a, a, same))) < 1e-12, float(kernel_distance(a, a)) < -1e-3
        (True, True)
    """
    own, other = torch.arange(len(a) + len(b)).split([len(a), len(b)]) if index is None else index
    one, two = (a.double(), own.to(a.device)), (b.double(), other.to(a.device))
    return _mean_kernel(one, one) + _mean_kernel(two, two) - 2 * _mean_kernel(one, two)


def _mean_kernel(one: tuple[Tensor, Tensor], two: tuple[Tensor, Tensor]) -> Float[Tensor, ""]:
    """Mean kernel over pairs of different index, of features and indices on both sides."""
    (a, own), (b, other) = one, two
    kernel, apart = (a @ b.T / a.shape[1] + 1) ** 3, own[:, None] != other
    return torch.where(apart, kernel, 0).sum() / apart.sum()
