"""Rows that were stopped go on from their checkpoints; rows that failed by themselves start anew."""

from __future__ import annotations

import signal

import pytest

from sag.sweep import main
from sag.sweep.status import Status, read_status

GO_ON = "--ckpt_path=last"


def left(workplace, row: str, **changes) -> None:
    """A row as an earlier sweep has left it, with a checkpoint, its log and an outdated figure."""
    main(["sweep.yaml"])
    workplace.forget()
    before = read_status(workplace.out / row)
    values = {**vars(before), **changes}
    Status(**values).write(workplace.out / row)
    workplace.write(f"runs/trial/{row}/checkpoints/last.ckpt", "weights")
    workplace.write(f"runs/trial/{row}/checkpoints/.last.ckpt.node.123", "half")
    workplace.write(f"runs/trial/{row}/log.txt", "said before\n")


def of(workplace, row: str) -> list[str]:
    (call,) = [call for call in workplace.calls() if call["row"] == row]
    return call["arguments"]


@pytest.mark.parametrize(
    "how",
    [
        {"state": "interrupted"},
        {"state": "running", "pid": 2**22 - 1},
        {"state": "waiting"},
        {"state": "failed", "returncode": -signal.SIGKILL},
        {"state": "failed", "returncode": 128 + signal.SIGTERM},
        {"state": "failed", "returncode": 75},
    ],
    ids=lambda how: f"{how['state']} {how.get('returncode', '')}",
)
def test_a_row_that_was_stopped_goes_on(workplace, how) -> None:
    left(workplace, "m", **how)
    assert main(["sweep.yaml"]) == 0
    assert workplace.names() == ["m"]
    assert of(workplace, "m")[-2:] == [GO_ON, "--trainer.default_root_dir=runs/trial/m"]
    assert [path.name for path in (workplace.out / "m/checkpoints").iterdir()] == ["last.ckpt"]
    assert (workplace.out / "m/log.txt").read_text() == "said before\nhello from m\n"


@pytest.mark.parametrize("returncode", [1, 2, 3])
def test_a_row_that_failed_by_itself_starts_anew(workplace, returncode) -> None:
    left(workplace, "m", state="failed", returncode=returncode)
    assert main(["sweep.yaml"]) == 0
    assert GO_ON not in of(workplace, "m") and not (workplace.out / "m/checkpoints").exists()


def test_a_row_of_another_command_starts_anew_even_if_it_waited_meanwhile(workplace) -> None:
    left(workplace, "m", state="interrupted")
    workplace.write("base.yaml", "a: 2")
    workplace.wishes(encoders={"fails": "before any row could start"})
    assert main(["sweep.yaml"]) == 1
    workplace.write("base.yaml", "a: 1")
    workplace.wishes()
    assert main(["sweep.yaml"]) == 0
    assert GO_ON not in of(workplace, "m")


def test_a_row_that_only_tests_does_not_go_on(workplace) -> None:
    left(workplace, "ground_truth", state="interrupted")
    assert main(["sweep.yaml"]) == 0
    assert GO_ON not in of(workplace, "ground_truth")


def test_a_row_that_diverges_says_why_and_the_sweep_goes_on(workplace, capsys) -> None:
    workplace.wishes(c={"fails": "train/critic/context is nan at step 3"})
    assert main(["sweep.yaml"]) == 1
    assert sorted(set(workplace.states().values())) == ["failed", "finished"]
    assert "c failed: exit status 1: ValueError: train/critic/context is nan at step 3" in capsys.readouterr().out


def test_what_a_killed_sweep_was_about_to_rename_is_removed(workplace) -> None:
    left(workplace, "m", state="interrupted")
    workplace.write("runs/trial/.c.99999999/log.txt", "half a copy")
    workplace.write("runs/trial/m/.progress.json.node.99999999", "half")
    assert main(["sweep.yaml"]) == 0
    assert not [path for path in workplace.out.rglob(".*") if path.suffix[1:].isdecimal()]
