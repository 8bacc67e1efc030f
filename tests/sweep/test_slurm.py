"""Sweeps through SLURM: a stand-in for its commands everywhere, and SLURM itself wherever `sinfo` answers."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest
from chaos import TinySweep

from sag.errors import SagError
from sag.sweep import heartbeat, main, slurm, slurm_job
from sag.sweep.rows import Row
from sag.sweep.slurm_job import SlurmJob
from sag.sweep.status import Status, read_status
from sag.sweep.tracked import Tracked

pytest.importorskip("submitit")

ALL = {"encoders", "ground_truth", "none", "c", "m", "mc", "blind"}
STAND_IN = Path(__file__).with_name("slurm_stand_in.py")


def silent() -> str | None:
    """Why SLURM cannot be asked here, if it cannot."""
    if shutil.which("sinfo") is None:
        return "no SLURM here: there is no sinfo"
    try:
        answered = subprocess.run(["sinfo", "--noheader"], capture_output=True, timeout=20, check=True).stdout
    except (OSError, subprocess.SubprocessError) as error:
        return f"SLURM does not answer: {error}"
    return None if answered.strip() else "SLURM has no partition"


SILENT = silent()
MARKS = [pytest.mark.slurm, pytest.mark.skipif(SILENT is not None, reason=str(SILENT))]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slurm, "POLL", 0.1)
    monkeypatch.setattr(slurm, "ASK", 0.5)


@pytest.fixture(params=["stand-in", pytest.param("slurm", marks=MARKS)])
def cluster(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """SLURM or its stand-in, whose folder this is."""
    folder = tmp_path / "slurm-commands"
    folder.mkdir()
    if request.param == "stand-in":
        for name in ("sbatch", "squeue", "srun", "scontrol", "job"):
            (folder / name).write_text(f"#!{sys.executable}\n{STAND_IN.read_text()}")
            (folder / name).chmod(0o755)
        monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    return folder


def wait_until(condition, seconds: float = 60) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.05)


def state(workplace, row: str) -> str | None:
    status = read_status(workplace.out / row)
    return status.state if status else None


def meanwhile(act) -> threading.Thread:
    """Something that is done while a sweep runs in this thread."""
    thread = threading.Thread(target=act, daemon=True)
    thread.start()
    return thread


def test_every_row_runs_once_after_the_encoders(cluster, workplace, capsys):
    assert main(["sweep.yaml", "--slurm"]) == 0
    assert set(workplace.states().values()) == {"finished"}
    assert sorted(workplace.names()) == sorted(ALL) and workplace.names()[0] == "encoders"
    assert workplace.calls()[1]["environment"]["SLURM_JOB_NAME"] == "interactive", "or Lightning requeues by itself"
    jobs = {row: workplace.status(row)["job"] for row in ALL}
    assert len({job.partition("_")[0] for row, job in jobs.items() if row != "encoders"}) == 1, "one array"
    assert len(set(jobs.values())) == 7 and "all 7 runs finished" in capsys.readouterr().out
    workplace.forget()
    assert main(["sweep.yaml", "--slurm"]) == 0 and workplace.names() == [], "finished rows are kept"


def test_without_encoders_nothing_else_starts(cluster, workplace, capsys):
    workplace.wishes(encoders={"fails": "no data"})
    assert main(["sweep.yaml", "--slurm"]) == 1
    assert workplace.names() == ["encoders"]
    assert "the other 6 runs need encoders; the same command tries again" in capsys.readouterr().out
    workplace.wishes()
    assert main(["sweep.yaml", "--slurm"]) == 0
    assert set(workplace.states().values()) == {"finished"}


def test_a_row_that_is_killed_fails_and_runs_again(cluster, workplace, capsys):
    workplace.wishes(m={"seconds": 60})
    meanwhile(lambda: (wait_until((workplace.out / "m/begun").exists), os.kill(workplace.status("m")["pid"], 9)))
    assert main(["sweep.yaml", "--slurm"]) == 1
    assert "m failed: killed by SIGKILL" in capsys.readouterr().out
    workplace.wishes()
    workplace.forget()
    assert main(["sweep.yaml", "--slurm"]) == 0 and workplace.names() == ["m"]


def parent(pid: int) -> int:
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def test_a_row_whose_job_dies_is_handed_over_again(cluster, workplace, monkeypatch):
    monkeypatch.setattr(heartbeat, "LOST", 12.0)
    workplace.wishes(m={"seconds": 60})

    def kill() -> None:
        wait_until((workplace.out / "m/begun").exists)
        workplace.wishes()
        os.kill(parent(workplace.status("m")["pid"]), signal.SIGKILL)

    meanwhile(kill)
    assert main(["sweep.yaml", "--slurm"]) == 0
    assert sorted(workplace.names()) == sorted([*ALL, "m"])
    assert set(workplace.states().values()) == {"finished"}


def test_a_warning_ends_the_row_and_queues_it_again(cluster, workplace):
    workplace.wishes(m={"seconds": 30})

    def warn() -> None:
        wait_until((workplace.out / "m/begun").exists)
        workplace.wishes()
        os.kill(parent(workplace.status("m")["pid"]), signal.SIGUSR2)

    meanwhile(warn)
    status = main(["sweep.yaml", "--slurm"])
    if list(cluster.iterdir()):
        asked = [path.name for path in cluster.glob("*.requeue")]
        assert status == 1 and asked == [f"{workplace.status('m')['job']}.requeue"]
        assert state(workplace, "m") == "interrupted"
    else:
        assert status == 0 and workplace.names().count("m") == 2


def test_the_rows_go_on_without_the_command_and_a_second_one_follows_them(cluster, workplace, capsys):
    workplace.wishes(m={"seconds": 6})
    assert main(["sweep.yaml", "--slurm", "--detach"]) == 0
    assert "--status" in capsys.readouterr().out
    wait_until((workplace.out / "m/begun").exists)
    main(["sweep.yaml", "--status"])
    shown = capsys.readouterr().out
    assert "running" in shown and workplace.status("m")["job"] in shown
    with pytest.raises(SagError, match=r"row \w+ runs on .* in job .*; wait for it"):
        main(["sweep.yaml"])
    assert main(["sweep.yaml", "--slurm"]) == 0
    assert sorted(workplace.names()) == sorted(ALL), "no row ran twice"


def test_what_slurm_refuses_is_said_in_its_words(cluster, workplace):
    with pytest.raises(SagError, match=r"SLURM refuses the jobs: .*invalid partition specified: nowhere"):
        main(["sweep.yaml", "--slurm", "--partition", "nowhere"])


def test_options_reach_sbatch(cluster, workplace):
    options = ["--time", "1:00:00", "--cpus", "1", "--mem", "100M", "--sbatch", "comment=hello", "--jobs", "3"]
    assert main(["sweep.yaml", "--slurm", *options]) == 0
    scripts = [path.read_text() for path in (workplace.out / "slurm").glob("*.sh")]
    lines = ["time=1:00:00", "cpus-per-task=1", "mem=100M", "comment=hello", "requeue", "signal=USR2@90"]
    assert all(f"#SBATCH --{line}\n" in script for script in scripts for line in lines)
    assert any("--array=0-5%3" in script and "--dependency=afterok:" in script for script in scripts)


def test_a_job_leaves_a_row_alone_that_another_one_has(workplace, capsys):
    folder = workplace.out / "m"
    Status("waiting", ("x",), "hash", ticket="new").write(folder)
    SlurmJob("trial", Row("m", ("touch", "ran"), "hash"), folder, "old")()
    assert "not this job's any more" in capsys.readouterr().out
    assert not Path("ran").exists() and read_status(folder) == Status("waiting", ("x",), "hash", ticket="new")


def test_a_job_that_loses_its_row_ends_it_and_writes_no_more(workplace, monkeypatch):
    monkeypatch.setattr(heartbeat, "EVERY", 0.1)
    workplace.wishes(m={"seconds": 30})
    folder = workplace.out / "m"
    row = Row("m", (sys.executable, "program.py"), "hash")
    Status("waiting", row.command, "hash", ticket="old").write(folder)
    given = Status("waiting", row.command, "hash", ticket="new")
    meanwhile(lambda: (wait_until((folder / "begun").exists), given.write(folder)))
    with pytest.raises(SagError, match="killed by SIGKILL"):
        SlurmJob("trial", row, folder, "old")()
    assert read_status(folder) == given


def test_rows_that_come_later_wait_for_encoders_that_are_on_their_way(workplace, cluster):
    workplace.wishes(encoders={"seconds": 5})
    assert main(["sweep.yaml", "--slurm", "--detach"]) == 0
    status = read_status(workplace.out / "m")
    replace(status, ticket="none has it").write(workplace.out / "m")
    assert main(["sweep.yaml", "--slurm"]) == 0
    assert sorted(workplace.names()) == sorted(ALL) and workplace.names()[0] == "encoders"


def test_a_row_that_gets_nowhere_is_not_queued_for_ever(workplace, monkeypatch, capsys):
    folder = workplace.out / "m"
    status = Status("interrupted", ("x",), "hash", started=time.time() - 5, returncode=143)
    status.write(folder)
    tracked = Tracked(Row("m", ("x",), "hash"), folder, status)
    asked = []
    monkeypatch.setattr(slurm_job, "_slurm", lambda *command: asked.append(command) or "")
    monkeypatch.setenv("SLURM_JOB_ID", "7")
    for restarts, times in (("0", 1), ("2", 2), ("3", 2)):
        monkeypatch.setenv("SLURM_RESTART_COUNT", restarts)
        slurm_job._queue_again(tracked)
        assert asked == [("scontrol", "requeue", "7")] * times
    assert workplace.status("m")["state"] == "failed" and "give more by --time" in workplace.status("m")["reason"]
    workplace.write("runs/trial/m/checkpoints/last.ckpt", "written in this try")
    slurm_job._queue_again(tracked)
    assert len(asked) == 3, "a checkpoint is a step ahead"


@pytest.mark.parametrize("flag", ["--partition=gpu", "--time=1:00", "--sbatch=a=b", "--detach"])
def test_options_of_slurm_want_slurm(workplace, flag):
    with pytest.raises(SagError, match=rf"{flag.partition('=')[0]} is for a SLURM cluster: add --slurm"):
        main(["sweep.yaml", flag])


def test_a_machine_without_slurm_says_so(workplace, monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(SagError, match="there is no SLURM here"):
        main(["sweep.yaml", "--slurm"])


@pytest.mark.slurm
@pytest.mark.slow
@pytest.mark.skipif(SILENT is not None, reason=str(SILENT))
def test_killed_rows_end_as_undisturbed_ones(tmp_path):
    """Real rows: one cancelled by `scancel`, one killed by kill -9; the same command makes the table whole."""
    rows = ("none", "m")
    whole, hurt = TinySweep(tmp_path / "whole", rows, epochs=30), TinySweep(tmp_path / "hurt", rows, epochs=30)
    assert whole.start().wait(300) == 0, whole.log()
    disturbed = hurt.start("--slurm")
    for row, end in (("none", cancel), ("m", kill_row)):
        wait_until((hurt.out / row / "checkpoints/last.ckpt").is_file, 200)
        end(json.loads((hurt.out / row / "status.json").read_text()))
    assert disturbed.wait(200) == 1, hurt.log()
    assert json.loads((hurt.out / "none/status.json").read_text())["state"] == "interrupted"
    assert "m failed: killed by SIGKILL" in hurt.log()
    assert hurt.start("--slurm").wait(200) == 0, hurt.log()
    assert all("training goes on from" in (hurt.out / row / "log.txt").read_text() for row in rows)
    assert hurt.figures() == whole.figures() and not hurt.unreadable()


def cancel(status: dict) -> None:
    subprocess.run(["scancel", status["job"]], check=True)


def kill_row(status: dict) -> None:
    os.kill(status["pid"], signal.SIGKILL)
