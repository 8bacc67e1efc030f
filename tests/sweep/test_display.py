import io
import time

import pytest
from rich.console import Console

from sag.sweep.display import LiveTable, PlainLines
from sag.sweep.estimate import duration, fraction_done, remaining, remaining_of_all
from sag.sweep.rows import Row
from sag.sweep.status import Progress, Status
from sag.sweep.table import event, summary, visible
from sag.sweep.tracked import Tracked


def tracked(folder, name, state, progress=None, **status):
    row = Tracked(Row(name, ("run",), "hash"), folder / name, Status(state, ("run",), "hash", **status))
    row.progress = progress or Progress()
    row.process = object() if state == "running" else None
    return row


@pytest.fixture
def rows(tmp_path):
    """One row that took 100 s, one half way through its training, one that failed, one that waits."""
    now = time.time()
    return [
        tracked(tmp_path, "none", "finished", started=now - 200, ended=now - 100),
        tracked(tmp_path, "m", "running", Progress(350, 700, "fit"), pid=7, started=now - 45),
        tracked(tmp_path, "d", "failed", started=now - 9, ended=now, returncode=1, reason="no depth"),
        tracked(tmp_path, "md", "waiting"),
    ]


def test_the_fraction_grows_from_training_to_test():
    stages = [Progress(), Progress(0, 700, "fit"), Progress(700, 700, "fit"), Progress(1, 2, "test")]
    assert [p.fraction for p in stages] == pytest.approx([0, 0, 0.9, 0.95])
    assert Progress(3, 2, "test").fraction == 1


def test_what_is_left_follows_the_pace_of_the_rows(rows):
    assert [fraction_done(row) for row in rows] == pytest.approx([1, 0.45, 1, 0])
    assert remaining(rows[1]) == pytest.approx(55, abs=1)
    one, two = remaining_of_all(rows, 1), remaining_of_all(rows, 2)
    assert one == pytest.approx(155, abs=2), "1.55 rows of 100 s"
    assert two == pytest.approx(one / 2, rel=0.01)
    assert remaining_of_all(rows[3:], 2) is None


@pytest.mark.parametrize(
    ("seconds", "text"), [(None, ""), (0.4, "0 s"), (59.7, "1 min 00 s"), (185, "3 min 05 s"), (4800, "1 h 20 min")]
)
def test_durations_are_for_people(seconds, text):
    assert duration(seconds) == text


def test_the_summary_says_what_matters(rows):
    said = summary(rows, 2)
    for part in ("1 of 4 finished", "1 failed", "m fit 350/700", "61 % done", "left"):
        assert part in said


def test_a_small_terminal_shows_what_runs_or_failed(rows):
    assert [row.row.name for row in visible(rows, 2)] == ["m", "d"]
    assert [row.row.name for row in visible(rows, 99)] == ["none", "m", "d", "md"]


def test_plain_lines_say_every_change_and_a_heartbeat(rows, monkeypatch):
    text = io.StringIO()
    lines = PlainLines(rows, 2, Console(file=text, width=80))
    lines.changed(rows[2])
    lines.tick()
    assert text.getvalue().count("\n") == 1, "too early for a heartbeat"
    assert f"d: failed after 9 s (no depth), log {rows[2].folder}/log.txt" in text.getvalue()
    monkeypatch.setattr("sag.sweep.display.SUMMARY_EVERY", 0)
    lines.tick()
    assert summary(rows, 2)[:15] in text.getvalue()


def test_the_live_table_shows_every_row(rows):
    text = io.StringIO()
    console = Console(file=text, force_terminal=True, width=160, height=40)
    with LiveTable(rows, 2, console) as table:
        table.changed(rows[2])
        table.tick()
    for part in ("none", "running", "fit 350/700", "failed", "waiting", "no depth", "% done"):
        assert part in text.getvalue()


def test_every_state_has_its_sentence(rows):
    assert event(rows[0]) == "finished in 1 min 40 s"
    assert event(rows[1]).startswith("started, process 7")
    rows[3].status = Status("interrupted", (), "", started=1.0, ended=6.0)
    assert event(rows[3]) == "interrupted after 5 s"
