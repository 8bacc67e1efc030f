from types import SimpleNamespace

import pytest
import torch

from sag.errors import SagError
from sag.methods import SAG
from sag.methods.rates import falling, set_rates


def method(epochs: int = 10, batches: float = 4) -> SimpleNamespace:
    optimizers = [torch.optim.Adam([torch.zeros(1, requires_grad=True)], 0.1) for _ in range(2)]
    trainer = SimpleNamespace(max_epochs=epochs, num_training_batches=batches, optimizers=optimizers)
    return SimpleNamespace(trainer=trainer)


def rates(of: SimpleNamespace) -> list[float]:
    return [optimizer.param_groups[0]["lr"] for optimizer in of.trainer.optimizers]


def test_a_rate_is_kept_and_then_falls_in_a_line_to_nothing() -> None:
    assert [falling(done, 0.5) for done in (0.0, 0.5, 0.75, 1.0)] == [1, 1, 0.5, 0]
    assert falling(0.25, 0.0) == 0.75


def test_all_optimisers_follow_the_batch_alone() -> None:
    one = method()
    for batch, expected in ((0, 0.2), (20, 0.2), (30, 0.1), (10, 0.2)):
        set_rates(one, batch, 0.2, 0.5)
        assert rates(one) == pytest.approx([expected] * 2)


def test_1_leaves_the_rates_alone() -> None:
    one = method()
    set_rates(one, 39, 0.5, 1.0)
    assert rates(one) == [0.1, 0.1]


@pytest.mark.parametrize(("epochs", "batches"), [(-1, 4), (10, float("inf"))])
def test_a_training_without_end_is_refused(epochs: int, batches: float) -> None:
    with pytest.raises(SagError, match="max_epochs"):
        set_rates(method(epochs, batches), 0, 0.1, 0.5)


@pytest.mark.parametrize("share", [-0.1, 1.5])
def test_a_share_out_of_range_is_refused(share: float) -> None:
    with pytest.raises(SagError, match="falling_from"):
        SAG(image_size=(36, 64), falling_from=share)
