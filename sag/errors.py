"""Errors that a user can act on, and the exit status of each kind."""

from __future__ import annotations

import signal

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells have it."""


class SagError(Exception):
    """A mistake in the input, said in one sentence that names the file, field or flag and the way out.

    The command line prints the sentence alone and exits with `status`.

    Attributes:
        status: exit status of a command that ends by it.
    """

    status = 2


class Damaged(SagError):
    """A file that is not as it was written: a checksum differs, or an end is missing."""


class Diverged(SagError):
    """A training whose losses or weights are no numbers any more, or beyond all bounds."""

    status = 3


class OutOfSpace(SagError):
    """A file for which the disk has no room: the command can go on once there is (sysexits' EX_TEMPFAIL)."""

    status = 75


class Interrupted(SagError):
    """A command that was asked to end and did.

    Args:
        sentence: what was saved, and how to go on.
        number: the signal that asked; the exit status is a shell's for it.
    """

    def __init__(self, sentence: str, number: int) -> None:
        super().__init__(f"{signal.Signals(number).name}: {sentence}")
        self.status = 128 + number
