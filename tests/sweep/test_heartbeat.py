"""Heartbeats tell which rows live, and `--status` tells it to people, from the folders of the rows alone."""

import json
import os
import platform
import time

import pytest

from sag.errors import SagError
from sag.sweep import heartbeat, main
from sag.sweep.status import Status


def row(workplace, name: str, state: str = "running", beaten: float | None = 1.0, **changes) -> None:
    """A row that a sweep elsewhere has, last seen alive so many seconds ago."""
    now = time.time()
    beat = None if beaten is None else now - beaten
    status = Status(state, ("x", "y"), "hash", pid=2**22 - 1, started=now - 100, heartbeat=beat, **changes)
    status.write(workplace.out / name)


def test_a_row_beats_while_it_runs(workplace, monkeypatch):
    monkeypatch.setattr(heartbeat, "EVERY", 0.2)
    workplace.wishes(m={"seconds": 2})
    main(["sweep.yaml"])
    status = workplace.status("m")
    assert (
        status["host"] == platform.node()
        and status["ended"] - status["heartbeat"] < 1 < status["ended"] - status["started"]
    )


@pytest.mark.parametrize("place", [{"host": "node5", "job": "12_3"}, {"host": "node5"}, {"job": "12_3"}])
def test_a_row_that_lives_elsewhere_is_not_run_here(workplace, place):
    row(workplace, "m", **{"host": platform.node(), **place})
    with pytest.raises(SagError, match=rf"row m runs on {place.get('host', platform.node())}.*; wait for it"):
        main(["sweep.yaml"])
    assert workplace.names() == []


def test_a_row_whose_heartbeat_has_stopped_is_run_again(workplace):
    row(workplace, "m", beaten=heartbeat.LOST + 1, host="node5", job="12_3")
    assert main(["sweep.yaml"]) == 0
    assert "m" in workplace.names() and workplace.status("m")["job"] is None


def test_the_status_is_told_from_the_folders_alone(workplace, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "120")
    row(workplace, "none", "finished", ended=time.time() - 40)
    row(workplace, "m", beaten=7, host="node5", job="12_3")
    workplace.write("runs/trial/m/progress.json", json.dumps({"step": 350, "steps": 700, "stage": "fit"}))
    row(workplace, "c", beaten=300, host="node6", gpus="1")
    row(workplace, "mc", "failed", ended=time.time(), returncode=1, reason="exit status 1: no depth")
    workplace.write("runs/trial/mc/log.txt", "first\nValueError: no depth\n")
    row(workplace, "blind", "waiting", beaten=None)
    os.utime(workplace.out / "m/status.json")
    before = {path: path.stat().st_mtime_ns for path in workplace.folder.rglob("*")}
    assert main(["sweep.yaml", "--status"]) == 1
    said = capsys.readouterr().out
    lines = {line.split()[0]: line for line in said.split("logs:")[0].splitlines() if line.strip()}
    for name, parts in {
        "m": ("running", "fit 350/700", "node5 job 12_3", "7 s"),
        "c": ("lost", "node6 GPU 1"),
        "none": ("finished",),
        "blind": ("waiting",),
    }.items():
        assert all(part in lines[name] for part in parts), lines[name]
    assert "1 of 5 finished; 1 failed; 1 lost" in said and "logs: runs/trial/ROW/log.txt" in said
    assert "mc failed: exit status 1: no depth" in said and "runs/trial/mc/log.txt" in said and "| ValueError" in said
    assert "c was left running on node6 and gave no sign of life for 120 s" in said
    assert {path: path.stat().st_mtime_ns for path in workplace.folder.rglob("*")} == before, "nothing was touched"


def test_a_sweep_that_never_ran_has_no_status(workplace):
    with pytest.raises(SagError, match="runs/trial holds no rows of a sweep; run it first"):
        main(["sweep.yaml", "--status"])
