"""Training by several processes at once, as Lightning's DDP does it, with what adversarial training asks beyond it."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager

import lightning.pytorch as pl
from lightning.pytorch.strategies import DDPStrategy, Strategy
from lightning.pytorch.strategies.launchers.subprocess_script import _SubprocessScriptLauncher

from sag.errors import SagError
from sag.models.batch_norm import OverProcesses

GRACE = 5.0
"""Seconds that a process which another has started keeps its mistake to itself: most are that one's too."""


def share_out(strategy: Strategy, processes: int) -> None:
    """Makes DDP fit for a generator and critics that take steps by turns.

    In each step some weights get no gradient: the critics' in the generator's, and the other way round. DDP has to look
    for them, or the second step fails.

    Args:
        strategy: Lightning's.
        processes: how many there are.

    Raises:
        SagError: several processes by another strategy than DDP.
    """
    if isinstance(strategy, DDPStrategy):
        strategy._ddp_kwargs.setdefault("find_unused_parameters", True)
    elif processes > 1:
        raise SagError(
            f"trainer.strategy is {type(strategy).__name__}, and only DDP trains several critics by turns: use "
            "--config configs/strategy/ddp.yaml, or leave it out"
        )


class Together(pl.Callback):
    """Processes that do one piece of work: they normalise together, and none is left behind when the first ends.

    Args:
        norms: whether batch norms see the windows of all processes.
    """

    def __init__(self, norms: bool) -> None:
        self.norms = norms

    def setup(self, trainer: pl.Trainer, pl_module: pl.LightningModule, stage: str) -> None:
        """Tells batch norms whose windows they see."""
        for module in pl_module.modules():
            if isinstance(module, OverProcesses):
                module.together = self.norms

    def on_exception(self, trainer: pl.Trainer, pl_module: pl.LightningModule, exception: BaseException) -> None:
        """Ends the processes that this one has started, which would wait for it for ever; only this one writes."""
        launcher = trainer.strategy.launcher
        if isinstance(launcher, _SubprocessScriptLauncher):
            launcher.kill(signal.SIGKILL)


@contextmanager
def first_process_speaks() -> Iterator[None]:
    """Gives the first process of a machine time to say what is wrong before the others do, and to end them."""
    try:
        yield
    except SagError:
        if int(os.environ.get("LOCAL_RANK", 0)):
            time.sleep(GRACE)
        raise
