import pytest
import torch

from sag.losses import berhu, critic_loss, generator_loss, gradient_penalty


def test_critic_and_generator_pull_apart() -> None:
    real, fake = torch.tensor([2.0, 4.0]), torch.tensor([1.0, 0.0])
    assert critic_loss(real, fake).item() == pytest.approx(0.5 - 3.0)
    assert generator_loss(fake).item() == pytest.approx(-0.5)


@pytest.mark.parametrize("target", [0.1, 1.0])
def test_penalty_of_a_linear_critic(target: float) -> None:
    weight = torch.randn(3, 5, dtype=torch.float64)
    norm = weight.norm()
    real, fake = torch.randn(2, 4, 3, 5, dtype=torch.float64)
    found = gradient_penalty(lambda x: (x * weight).sum((1, 2)), real, fake, target)
    assert found.item() == pytest.approx((norm - target).square().item(), rel=1e-6)


def test_penalty_of_each_frame() -> None:
    weight = torch.randn(3, 5, dtype=torch.float64)
    real, fake = torch.randn(2, 4, 3, 5, dtype=torch.float64)
    found = gradient_penalty(lambda x: (x * weight).sum((1, 2)), real, fake, 1.0, axes=2)
    assert found.item() == pytest.approx((weight.norm(dim=1) - 1).square().mean().item(), rel=1e-6)


def test_penalty_trains_the_critic_and_not_the_views() -> None:
    weight = torch.randn(5, requires_grad=True)
    fake = torch.randn(4, 5, requires_grad=True)
    gradient_penalty(lambda x: (x @ weight).tanh(), torch.randn(4, 5), fake, 0.1).backward()
    assert weight.grad.abs().sum() > 0
    assert fake.grad is None


def test_penalty_survives_a_dead_critic() -> None:
    weight = torch.zeros(5, requires_grad=True)
    penalty = gradient_penalty(lambda x: x @ weight, torch.randn(4, 5), torch.randn(4, 5), 0.1)
    penalty.backward()
    assert penalty.item() == pytest.approx(0.01, rel=1e-3)
    assert weight.grad.isfinite().all()


def test_berhu_is_the_formula() -> None:
    true = torch.full((1, 1, 4), 5.0)
    predicted = true + torch.tensor([0.1, -0.2, 1.0, 0.5])
    c = 0.2
    wanted = (0.1 + 0.2 + (1 + c**2) / (2 * c) + (0.25 + c**2) / (2 * c)) / 4
    assert berhu(predicted, true).item() == pytest.approx(wanted, rel=1e-5)


def test_berhu_is_continuous_at_its_threshold() -> None:
    true = torch.full((1, 1, 2), 5.0, dtype=torch.float64)
    below, above = (berhu(true + torch.tensor([1.0, 0.2 + step]), true) for step in (-1e-9, 1e-9))
    assert below.item() == pytest.approx(above.item(), abs=1e-8)


def test_berhu_leaves_unknown_depth_out() -> None:
    true = torch.tensor([[[0.0, 2.0]]])
    predicted = torch.tensor([[[9.0, 2.5]]], requires_grad=True)
    berhu(predicted, true).backward()
    assert predicted.grad[0, 0, 0] == 0
    assert predicted.grad[0, 0, 1] != 0
    assert berhu(predicted, torch.zeros(1, 1, 2)).item() == 0


def test_berhu_gradient() -> None:
    true = torch.rand(2, 3, 4, dtype=torch.float64) + 1
    predicted = (true + torch.randn_like(true)).requires_grad_()
    threshold = 0.2 * (predicted - true).abs().max().item()
    error = (predicted - true).detach()
    slope = torch.where(error.abs() <= threshold, error.sign(), error / threshold) / error.numel()
    berhu(predicted, true).backward()
    assert torch.allclose(predicted.grad, slope)
