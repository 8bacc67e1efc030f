"""How far a sweep is and how long it will still take, from what its rows have taken so far."""

from __future__ import annotations

import time
from collections.abc import Sequence

from sag.sweep.tracked import Tracked

TELLING = 0.03
"""Share of a row from which its pace says something."""


def fraction_done(tracked: Tracked) -> float:
    """Share of a row that is done, 0 to 1."""
    return 1.0 if tracked.status.state in ("finished", "failed") else tracked.progress.fraction


def elapsed(tracked: Tracked) -> float | None:
    """Seconds that a row has run, or None before it starts."""
    status = tracked.status
    if status.started is None:
        return None
    return (status.ended or time.time()) - status.started


def remaining(tracked: Tracked) -> float | None:
    """Seconds that a running row still takes at its pace, or None while that says nothing."""
    fraction, seconds = tracked.progress.fraction, elapsed(tracked)
    if tracked.status.state != "running" or seconds is None or fraction < TELLING:
        return None
    return seconds * (1 - fraction) / fraction


def remaining_of_all(rows: Sequence[Tracked], jobs: int) -> float | None:
    """Seconds until the sweep ends, or None while no row of the grid has shown its pace.

    What is left, in rows, times what a row takes, shared by the jobs; never less than the slowest running row needs.
    """
    whole = [t.status.seconds for t in rows if t.row.typical and t.status.state == "finished" and t.status.seconds]
    running = [t for t in rows if t.row.typical and remaining(t) is not None]
    whole += [elapsed(t) / t.progress.fraction for t in running]  # type: ignore[operator]
    if not whole:
        return None
    left = sum(1 - fraction_done(t) for t in rows if t.row.typical)
    return max(left * sum(whole) / len(whole) / jobs, *(remaining(t) or 0.0 for t in rows), 0.0)


def duration(seconds: float | None) -> str:
    """A length of time for people: `48 s`, `3 min 05 s`, `1 h 20 min`."""
    if seconds is None:
        return ""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
