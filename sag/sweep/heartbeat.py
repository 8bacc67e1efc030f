"""Heartbeats: what starts a row writes now and then into its `status.json` that it lives.

So rows tell by themselves whether they run, on whatever machine, and no scheduler has to be asked or believed.
"""

from __future__ import annotations

import platform
import time

from sag.sweep.status import Status

EVERY = 10.0
"""Seconds between two heartbeats."""

LOST = 120.0
"""Seconds without a heartbeat after which a row is given up: file servers may show a file a minute late."""


def age(status: Status) -> float | None:
    """Seconds since the last heartbeat of a row that runs, or None where it does not run or never had one."""
    if status.state != "running" or status.heartbeat is None:
        return None
    return max(time.time() - status.heartbeat, 0.0)


def is_due(status: Status) -> bool:
    """Whether it is time for the next heartbeat."""
    seconds = age(status)
    return seconds is None or seconds >= EVERY


def is_alive(status: Status) -> bool:
    """Whether a row runs, as far as its heartbeats tell."""
    seconds = age(status)
    return seconds is not None and seconds < LOST


def is_lost(status: Status) -> bool:
    """Whether a row was left running by something that has died since, with its machine perhaps."""
    return status.state == "running" and not is_alive(status)


def is_elsewhere(status: Status) -> bool:
    """Whether a row runs where no process of this machine may be ended for it: in a job, or on another machine."""
    return is_alive(status) and (status.job is not None or status.host != platform.node())
