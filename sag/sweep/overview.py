"""`sag sweep FILE --status`: how far a sweep is, from the folders of its rows alone."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from sag.errors import SagError
from sag.sweep.closing import say, tell_failed
from sag.sweep.heartbeat import LOST
from sag.sweep.rows import ENCODERS_ROW, GROUND_TRUTH_ROW, Row
from sag.sweep.status import LOG, STATUS, read_progress, read_status
from sag.sweep.table import rows_table, state_of, summary
from sag.sweep.tracked import Tracked


def show(name: str, out: Path, console: Console) -> int:
    """Shows every row, then why rows failed; the exit status is 1 when one has failed or is lost.

    Raises:
        SagError: no sweep has been in the folder.
    """
    rows = read_rows(out)
    running = sum(state_of(row) == "running" for row in rows)
    say(console, f"{name}: {len(rows)} rows in {out}")
    console.print(rows_table(rows, summary(rows, max(running, 1))))
    tell_failed([row for row in rows if row.status.state == "failed"], console)
    lost = [row for row in rows if state_of(row) == "lost"]
    for row in lost:
        where = f" on {row.status.host}" if row.status.host else ""
        say(console, f"\n{row.row.name} was left running{where} and gave no sign of life for {LOST:.0f} s", "yellow")
        say(console, f"  log: {row.folder / LOG}; the command that ran the sweep runs it again")
    return 1 if lost or any(row.status.state == "failed" for row in rows) else 0


def read_rows(out: Path) -> list[Tracked]:
    """The rows of a sweep in the order of their first start, those that wait last.

    Raises:
        SagError: no sweep has been in the folder.
    """
    found = []
    for path in sorted(out.glob(f"*/{STATUS}")):
        folder, status = path.parent, read_status(path.parent)
        if status:
            typical = folder.name not in (ENCODERS_ROW, GROUND_TRUTH_ROW)
            row = Row(folder.name, status.command, status.command_hash, typical=typical)
            found.append(Tracked(row, folder, status, read_progress(folder)))
    if not found:
        raise SagError(f"{out} holds no rows of a sweep; run it first, or say by --out where it was run")
    return sorted(found, key=lambda row: (row.status.started or float("inf"), row.row.name))
