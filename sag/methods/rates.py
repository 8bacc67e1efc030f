"""Learning rates that fall towards the end of a training."""

from __future__ import annotations

from typing import Any

from sag.errors import SagError


def checked_share(share: float) -> float:
    """The share of a training, if it is one.

    Raises:
        SagError: it does not lie in [0, 1].
    """
    if not 0 <= share <= 1:
        raise SagError(f"model.init_args.falling_from is {share}; it must be at least 0 and at most 1")
    return share


def falling(done: float, start: float) -> float:
    """Factor on a rate after a share of the training: 1 until `start`, then in a line to 0 at the end."""
    return 1.0 if done <= start else max(0.0, (1 - done) / (1 - start))


def set_rates(method: Any, batch: int, rate: float, start: float) -> None:
    """Sets the rates of all optimisers for a batch, counted over the whole fit, so that a resumed run has the same.

    Args:
        method: a LightningModule in training.
        batch: batches before this one.
        rate: before it falls.
        start: share of the training after which it falls; 1 leaves everything alone.

    Raises:
        SagError: the rate is to fall in a training without end.
    """
    if start == 1:
        return
    trainer = method.trainer
    batches = (trainer.max_epochs or 0) * trainer.num_training_batches
    if not 0 < batches < float("inf"):
        raise SagError("model.init_args.falling_from below 1 needs to know the end: give trainer.max_epochs")
    for optimizer in trainer.optimizers:
        for group in optimizer.param_groups:
            group["lr"] = rate * falling(batch / batches, start)
