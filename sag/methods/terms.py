"""Terms of a loss: logged by their names, and watched, so that a training that goes wrong ends at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import lightning.pytorch as pl
import torch
from torch import Tensor

from sag.errors import Diverged
from sag.processes import processes, summed

LOSS_LIMIT = 1e6
"""Magnitude beyond which a term has exploded, where the trainer names none (`trainer.loss_limit`)."""


def record(module: pl.LightningModule, terms: Mapping[str, Tensor]) -> None:
    """Logs terms, once each is found to be a number within the limit; called before the step that they ask for.

    All terms of a call are looked at together, which waits for the device once. Processes that train together look at
    the average of their terms, which is the term of their whole batch, so that they agree on what they find.

    Args:
        module: what is trained.
        terms: scalars by the names that they are logged under.

    Raises:
        Diverged: a term is no number, or beyond `trainer.loss_limit`; the sentence names the first and the step.
    """
    trainer: Any = module.trainer
    limit = getattr(trainer, "loss_limit", LOSS_LIMIT)
    together = summed(torch.stack([term.detach().float() for term in terms.values()])) / processes()
    for name, value in zip(terms, together.tolist()):
        if not abs(value) <= limit:
            raise Diverged(_sentence(trainer, name, value, limit))
    module.log_dict(dict(zip(terms, together.unbind())))


def _sentence(trainer: Any, name: str, value: float, limit: float) -> str:
    loop = trainer.fit_loop.epoch_loop
    place = f"step {loop.total_batch_idx} (batch {loop.batch_idx} of epoch {trainer.current_epoch})"
    found = f"{value:g}, beyond trainer.loss_limit {limit:g}," if abs(value) < float("inf") else f"{value}"
    return (
        f"{name} is {found} at {place}: training stops here, and checkpoints of before stay as they are; look at the "
        "data of that batch, or lower the learning rate"
    )
