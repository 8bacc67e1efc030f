"""Terms of a loss: logged by their names, and watched, so that a training that goes wrong ends at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import lightning.pytorch as pl
import torch
from torch import Tensor

from sag.errors import Diverged

LOSS_LIMIT = 1e6
"""Magnitude beyond which a term has exploded, where the trainer names none (`trainer.loss_limit`)."""


def record(module: pl.LightningModule, terms: Mapping[str, Tensor]) -> None:
    """Logs terms, once each is found to be a number within the limit; called before the step that they ask for.

    All terms of a call are looked at together, which waits for the device once.

    Args:
        module: what is trained.
        terms: scalars by the names that they are logged under.

    Raises:
        Diverged: a term is no number, or beyond `trainer.loss_limit`; the sentence names the first and the step.
    """
    trainer: Any = module.trainer
    limit = getattr(trainer, "loss_limit", LOSS_LIMIT)
    for name, value in zip(terms, torch.stack([term.detach().float() for term in terms.values()]).tolist()):
        if not abs(value) <= limit:
            raise Diverged(_sentence(trainer, name, value, limit))
    module.log_dict({name: term.detach() for name, term in terms.items()})


def _sentence(trainer: Any, name: str, value: float, limit: float) -> str:
    loop = trainer.fit_loop.epoch_loop
    place = f"step {loop.total_batch_idx} (batch {loop.batch_idx} of epoch {trainer.current_epoch})"
    found = f"{value:g}, beyond trainer.loss_limit {limit:g}," if abs(value) < float("inf") else f"{value}"
    return (
        f"{name} is {found} at {place}: training stops here, and checkpoints of before stay as they are; look at the "
        "data of that batch, or lower the learning rate"
    )
