"""Sweeps that are interrupted or killed: nothing is left running, and the same command continues."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

from sag.errors import SagError
from sag.sweep import main
from sag.sweep.status import Status, locked, read_status

LONG = {"none": {"seconds": 60}, "c": {"seconds": 60}}
CODE = "import sys; from sag.sweep import process, main; process.GRACE = 0.5; sys.exit(main(['sweep.yaml']))"


def wait_until(condition, seconds=20):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.02)


def alive(pid):
    """Whether a process runs; a zombie whose parent has gone does not."""
    with suppress(OSError), open(f"/proc/{pid}/stat") as stat:
        return stat.read().rpartition(")")[2].split()[0] not in "ZX"
    if os.path.exists("/proc/self/stat"):
        return False
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.fixture
def sweep(workplace):
    """A sweep in a process of its own, when two of its rows have begun a long sleep."""
    workplace.wishes(ground_truth={}, **LONG)
    process = subprocess.Popen([sys.executable, "-c", CODE], stdout=subprocess.PIPE, text=True)
    wait_until(lambda: all((workplace.out / row / "begun").exists() for row in LONG))
    yield process
    process.kill()
    process.communicate()


def pids(workplace):
    return [workplace.status(row)["pid"] for row in LONG]


def continues(workplace):
    workplace.wishes()
    workplace.forget()
    assert main(["sweep.yaml"]) == 0
    assert set(workplace.states().values()) == {"finished"}
    return set(workplace.names())


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_sweep_ends_its_rows_and_continues(workplace, sweep, sent):
    running = pids(workplace)
    sweep.send_signal(sent)
    said, _ = sweep.communicate(timeout=20)
    assert sweep.returncode == 130
    assert "run the same command again to continue" in said
    assert not any(alive(pid) for pid in running)
    assert {workplace.states()[row] for row in LONG} == {"interrupted"}
    assert continues(workplace) == {"none", "c", "m", "mc", "blind"}


def test_a_row_that_does_not_listen_is_killed(workplace):
    workplace.wishes(none={"seconds": 60, "stubborn": True})
    process = subprocess.Popen([sys.executable, "-c", CODE], stdout=subprocess.DEVNULL)
    wait_until((workplace.out / "none" / "begun").exists)
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 130
    assert workplace.status("none")["returncode"] == -signal.SIGKILL
    assert workplace.states()["none"] == "interrupted"


def test_a_killed_row_fails_and_the_rest_goes_on(workplace, sweep):
    victim, other = pids(workplace)
    os.kill(victim, signal.SIGKILL)
    wait_until(lambda: workplace.status("none")["state"] == "failed")
    assert "killed by SIGKILL" in workplace.status("none")["reason"]
    assert alive(other)
    wait_until(lambda: workplace.states()["mc"] == "finished")
    os.kill(other, signal.SIGKILL)
    assert sweep.wait(20) == 1
    assert continues(workplace) == {"none", "c"}


def test_a_killed_sweep_leaves_nothing_running_and_continues(workplace, sweep):
    running = pids(workplace)
    sweep.kill()
    sweep.wait()
    if sys.platform == "linux":
        wait_until(lambda: not any(alive(pid) for pid in running))
    assert workplace.states()["none"] == "running", "nobody was left to write otherwise"
    assert continues(workplace) == {"none", "c", "m", "mc", "blind"}
    assert not any(alive(pid) for pid in running)


def test_a_row_left_over_by_a_killed_sweep_is_ended_first(workplace):
    command = (sys.executable, "-c", "import time; time.sleep(60)", "--trainer.default_root_dir=runs/trial/m")
    orphan = subprocess.Popen(command, start_new_session=True)
    Status("running", command, "x", pid=orphan.pid).write(workplace.out / "m")
    assert main(["sweep.yaml"]) == 0
    assert orphan.wait(5) == -signal.SIGTERM


def test_a_process_that_took_over_a_number_is_left_alone(workplace):
    stranger = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"], start_new_session=True)
    command = ("x", "--trainer.default_root_dir=runs/trial/m")
    Status("running", command, "x", pid=stranger.pid).write(workplace.out / "m")
    try:
        assert main(["sweep.yaml"]) == 0
        assert stranger.poll() is None
    finally:
        stranger.kill()
        stranger.wait()


def test_two_sweeps_do_not_share_a_folder(workplace, sweep):
    with pytest.raises(SagError, match=f"process {sweep.pid}"):
        main(["sweep.yaml"])


def test_the_lock_of_a_dead_sweep_is_taken_over(workplace):
    workplace.out.mkdir(parents=True)
    (workplace.out / ".sweep.lock").write_text("999999")
    with locked(workplace.out):
        assert (workplace.out / ".sweep.lock").read_text() == str(os.getpid())


def test_a_status_that_cannot_be_read_is_no_status(workplace):
    workplace.write("runs/trial/m/status.json", '{"state": "fin')
    assert read_status(workplace.out / "m") is None
    status = Status("failed", ("a", "b"), "hash", pid=3, started=1.0, ended=3.5, returncode=1, reason="why")
    status.write(workplace.out / "m")
    assert read_status(workplace.out / "m") == status
    assert json.loads((workplace.out / "m" / "status.json").read_text())["state"] == "failed"
    assert status.seconds == 2.5
