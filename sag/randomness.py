"""Chance that goes on where it stopped: the state of every random generator, kept in checkpoints."""

from __future__ import annotations

import random
from typing import Any

import lightning.pytorch as pl
import numpy as np
import torch

from sag.processes import everyones

State = dict[str, Any]
"""State of every generator of a process, in tensors and plain types alone."""


class RandomStates(pl.Callback):
    """Keeps the state of Python's, NumPy's and PyTorch's generators in checkpoints, of each process its own.

    Lightning keeps none of them, so a run that goes on would draw other noise. The data's order is drawn from
    PyTorch's generator when an epoch begins, so it must be in place before that. In the midst of an epoch the order
    is told by the checkpoint (`sag.data.order`), but Lightning's loops still draw while they are set up: there the
    generators are put back once more before the first batch.
    """

    def __init__(self) -> None:
        self.states: list[State] = []
        self.mid_epoch = False

    def remember(self) -> None:
        """Takes the generators as they stand now: Lightning seeds them again where it starts several processes."""
        self.states, self.mid_epoch = [random_state()], False

    def state_dict(self) -> dict[str, Any]:
        """The generators of all processes."""
        return {"states": everyones(random_state()), "mid_epoch": self.mid_epoch}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Takes what a checkpoint knows, to put it in place when training starts."""
        self.states, self.mid_epoch = state_dict["states"], state_dict["mid_epoch"]

    def on_fit_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """Puts the generators where the checkpoint had them, for the order of an epoch that begins."""
        self._restore(trainer)
        if not self.mid_epoch:
            self.states = []

    def on_train_batch_start(self, trainer: pl.Trainer, *args: Any, **kwargs: Any) -> None:
        """Puts them there again, if the epoch had begun; from now on it is one that can stop midway."""
        self._restore(trainer)
        self.states, self.mid_epoch = [], True

    def on_train_epoch_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        """A checkpoint that is written now is between two epochs."""
        self.mid_epoch = False

    def _restore(self, trainer: pl.Trainer) -> None:
        if self.states:
            set_random_state(self.states[trainer.global_rank % len(self.states)])


def random_state() -> State:
    """State of every generator of this process."""
    version, words, gauss = random.getstate()
    kind, keys, *rest = np.random.get_state(legacy=True)
    return {
        "python": [version, torch.tensor(words), gauss],
        "numpy": [str(kind), torch.from_numpy(np.asarray(keys, np.int64)), *rest],
        "torch": torch.get_rng_state(),
        "cuda": torch.cuda.get_rng_state_all() if torch.cuda.is_available() else [],
    }


def set_random_state(state: State) -> None:
    """Puts every generator of this process where it was; generators of devices that are not here are left out."""
    version, words, gauss = state["python"]
    random.setstate((version, tuple(words.tolist()), gauss))
    kind, keys, *rest = state["numpy"]
    np.random.set_state((kind, keys.numpy().astype(np.uint32), *rest))
    torch.set_rng_state(state["torch"].cpu())
    if torch.cuda.is_available():
        for device, inner in enumerate(state["cuda"][: torch.cuda.device_count()]):
            torch.cuda.set_rng_state(inner.cpu(), device)
