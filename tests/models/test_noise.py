import math

import pytest
import torch

from sag.models.noise import GaussianProcess, covariance


@pytest.mark.parametrize(("kernel", "power"), [("exponential", 1), ("squared_exponential", 2)])
def test_covariance_is_the_formula(kernel: str, power: int) -> None:
    sigma = torch.tensor([0.5, 2.0], dtype=torch.float64)
    k = covariance(6, sigma, kernel)
    for c, s in enumerate((0.5, 2.0)):
        for a in range(6):
            for b in range(6):
                assert k[c, a, b] == pytest.approx(math.exp(-(abs(a - b) ** power) / (2 * s**2)), rel=1e-12)


@pytest.mark.parametrize("kernel", ["exponential", "squared_exponential"])
def test_samples_have_the_covariance(kernel: str) -> None:
    process = GaussianProcess(4, kernel=kernel)
    x = process(200_000, torch.Generator().manual_seed(1))
    wanted = process.factor @ process.factor.transpose(1, 2)
    found = torch.einsum("ncs,nct->cst", x, x) / len(x)
    assert torch.allclose(found, wanted, atol=0.02)
    assert x.mean(0).abs().max() < 0.02


def test_channels_differ_in_smoothness() -> None:
    factor = GaussianProcess(8).factor
    neighbour = (factor @ factor.transpose(1, 2))[:, 0, 1]
    assert (neighbour.diff() > 0).all()


def test_a_generator_repeats_it() -> None:
    process = GaussianProcess(3)
    first, again = (process(5, torch.Generator().manual_seed(7)) for _ in range(2))
    assert torch.equal(first, again)
    assert not torch.equal(first, process(5, torch.Generator().manual_seed(8)))
