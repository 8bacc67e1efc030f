"""The kernel distance of two sets of features, which does not depend on how many they are."""

from __future__ import annotations

from jaxtyping import Float
from torch import Tensor


def kernel_distance(a: Float[Tensor, "n d"], b: Float[Tensor, "m d"]) -> Float[Tensor, ""]:
    """The unbiased squared maximum mean discrepancy under the cubic kernel k(x, y) = (x.y / d + 1)^3, in float64.

    mean over i != j of k(a_i, a_j) + mean over i != j of k(b_i, b_j) - 2 mean over i, j of k(a_i, b_j)

    (Gretton et al., 2012; the kernel of Binkowski et al., ICLR 2018.) Its mean over samples is the true value at any
    number of samples, so for two samples of one distribution it scatters around 0 and may be negative.

    Args:
        a: at least 2 features.
        b: at least 2 features.

    Example:
        >>> import torch
        >>> draw = torch.manual_seed(0)
        >>> a, b = torch.randn(500, 8, generator=draw), torch.randn(500, 8, generator=draw)
        >>> abs(float(kernel_distance(a, b))) < 0.1, float(kernel_distance(a, b + 1)) > 1
        (True, True)
    """
    a, b = a.double(), b.double()
    return _mean_of_others(_kernel(a, a)) + _mean_of_others(_kernel(b, b)) - 2 * _kernel(a, b).mean()


def _kernel(a: Float[Tensor, "n d"], b: Float[Tensor, "m d"]) -> Float[Tensor, "n m"]:
    return (a @ b.T / a.shape[1] + 1) ** 3


def _mean_of_others(kernel: Float[Tensor, "n n"]) -> Tensor:
    """Mean over pairs of different features."""
    count = len(kernel)
    return (kernel.sum() - kernel.trace()) / (count * (count - 1))
