"""Training in stages by one fit: which of them a batch belongs to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sag.errors import SagError


def check_shares(shares: Sequence[float]) -> None:
    """Refuses shares of which one is not above 0.

    Raises:
        SagError: the sentence names the option.
    """
    if min(shares) <= 0:
        raise SagError(f"model.init_args.recipe.stages are {list(shares)}; each of them must be above 0")


def stages_due(trainer: Any, shares: Sequence[float]) -> list[int]:
    """Stages that the batch at hand belongs to, in order; more than one where it spans the end of a stage.

    Args:
        trainer: in the midst of a fit.
        shares: of all batches of the fit, one for each stage; together they are the whole, whatever their sum.

    Raises:
        SagError: the fit has no end, and so no shares.
    """
    if not trainer.max_epochs or trainer.max_epochs < 0:
        raise SagError("stages are trained for shares of a whole run: give trainer.max_epochs a number")
    batches = trainer.max_epochs * trainer.num_training_batches
    place = trainer.fit_loop.epoch_loop.total_batch_idx
    ends = [sum(shares[: i + 1]) / sum(shares) * batches for i in range(len(shares))]
    begins = [0.0, *ends[:-1]]
    # A rounding error must not make two stages of a batch that one ends with.
    return [i for i, (begin, end) in enumerate(zip(begins, ends)) if begin < place + 1 - 1e-6 and place < end - 1e-6]
