"""Requests to end, counted instead of obeyed, so that rows can be ended in order."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from contextlib import AbstractContextManager
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Ctrl-C, a request to end, and a closed terminal."""


class Interrupts(AbstractContextManager["Interrupts"]):
    """Counts signals that ask a program to end instead of dying of them.

    Args:
        signals: those that are counted.
        patient: whether a repeated request is one that has been heard already. Schedulers repeat theirs; a user who
            presses Ctrl-C again means it.
    """

    def __init__(self, signals: Sequence[signal.Signals] = SIGNALS, patient: bool = False) -> None:
        self.signals = signals
        self.patient = patient
        self.count = 0
        self._before: dict[signal.Signals, Any] = {}

    @property
    def insisted(self) -> bool:
        """Whether the user does not want to wait any more."""
        return self.count > 1 and not self.patient

    def __enter__(self) -> Interrupts:
        self._before = {s: signal.signal(s, self._counted) for s in self.signals}
        return self

    def _counted(self, number: int, frame: FrameType | None) -> None:
        self.count += 1

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
