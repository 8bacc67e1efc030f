"""What `sag doctor` says of devices, folders and services."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from doctor_findings import CPU, working

from sag.data.check.report import Line
from sag.doctor import folders, machine, services
from sag.doctor.probed import Probed

ROOT = Path(__file__).parents[2]


def gpu(error: str | None) -> Probed:
    each = {"name": "cuda:0", "about": "A GPU, 10 of 80 GB free", "error": error}
    return working(devices={"devices": [CPU, each], "built_for_cuda": "13.0", "backends": ["gloo", "nccl"]})


def test_a_gpu_that_does_not_compute_stops_a_run() -> None:
    cpu, line, together = machine.device_lines(gpu("RuntimeError: no kernel image"))
    assert (cpu.verdict, line.verdict, together.verdict) == ("ok", "broken", "ok")
    assert line.details[0] == "RuntimeError: no kernel image" and "CUDA_VISIBLE_DEVICES=" in line.details[2]
    assert machine.device_lines(gpu(None))[1].verdict == "ok"
    assert "gloo and nccl" in machine.device_lines(gpu(None))[2].value


def test_a_gpu_that_torch_does_not_see_is_worth_a_look(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(machine, "DRIVER", tmp_path / "version")
    monkeypatch.setattr(machine.shutil, "which", lambda name: None)
    assert [line.verdict for line in machine.device_lines(working())] == ["ok", "", "ok"]
    (tmp_path / "version").touch()
    line = machine.device_lines(working())[1]
    assert line.verdict == "look" and "built without CUDA" in line.value


@pytest.mark.parametrize(("kilobytes", "verdict"), [(8_000_000, "ok"), (3_000_000, "look"), (1_000_000, "broken")])
def test_memory_for_a_row(kilobytes: int, verdict: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(machine, "MEMORY", tmp_path / "meminfo")
    (tmp_path / "meminfo").write_text(f"MemTotal: 9 kB\nMemAvailable: {kilobytes} kB\n")
    assert machine.memory_line().verdict == verdict


def test_a_folder_that_cannot_be_written_stops_a_run(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    line = folders.folder_line("runs", tmp_path / "file" / "runs", 1, "choose another")
    assert line.verdict == "broken" and str(tmp_path / "file") in line.value and "choose another" in line.details[0]


def test_room_on_the_disk(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(folders.shutil, "disk_usage", lambda place: SimpleNamespace(free=1e9))
    verdicts = [folders.folder_line("data", tmp_path / "a/b", needed, "").verdict for needed in (0, 0.3e9, 0.6e9, 2e9)]
    assert verdicts == ["ok", "ok", "look", "broken"]
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "rooms-1").mkdir()
    (tmp_path / "rooms-1/index.json").touch()
    assert folders.needed_for_data(tmp_path) == 0 < folders.needed_for_data(tmp_path / "elsewhere")


def test_a_folder_without_configs_is_worth_a_look(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(ROOT)
    assert folders.clone_line().verdict == "ok"
    monkeypatch.chdir(tmp_path)
    assert folders.clone_line().verdict == "look"


def test_wandb_needs_an_account_only_online(tmp_path: Path, monkeypatch) -> None:
    for name in ("WANDB_MODE", "WANDB_API_KEY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("NETRC", str(tmp_path / "netrc"))
    monkeypatch.setenv("WANDB_BASE_URL", "http://localhost:1")
    assert services.wandb_line() == Line("W&B", "offline, the default: no account is needed", "ok")
    monkeypatch.setenv("WANDB_MODE", "online")
    assert services.wandb_line().verdict == "broken" and services.wandb_line().details[0] == "wandb login"
    (tmp_path / "netrc").write_text("machine localhost login user password secret-of-nobody\n")
    answers: list[Callable] = [refusing, lambda *place: SimpleNamespace(close=lambda: None)]
    for answer, verdict in zip(answers, ("look", "ok")):
        monkeypatch.setattr(services.socket, "create_connection", answer)
        assert services.wandb_line().verdict == verdict
        assert "secret" not in str(services.wandb_line())


def refusing(*place: Any) -> None:
    raise ConnectionRefusedError("refused")


SCHEDULERS = {
    "answers": ("echo 'debug*: 4 idle, gpu:8'; echo 'long: 2 alloc, (null)'", "debug*: 4 idle, gpu:8"),
    "fails": ("echo 'sinfo: error: Unable to contact slurm controller' >&2; exit 1", "Unable to contact"),
    "hangs": ("exec sleep 60", "slurmctld"),
}


@pytest.mark.parametrize("kind", SCHEDULERS)
def test_slurm(kind: str, tmp_path: Path, monkeypatch) -> None:
    script, said = SCHEDULERS[kind]
    (tmp_path / "sinfo").write_text(f"#!/bin/sh\n{script}\n")
    (tmp_path / "sinfo").chmod(0o755)
    monkeypatch.setattr(services, "PATIENCE", 1.0)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.setattr(services, "find_spec", lambda name: None)
    line = services.slurm_line()
    assert line.verdict == "look" and said in line.details[0]
    assert ("pip install 'sag[slurm]'" in line.details) == (kind == "answers")
    monkeypatch.setattr(services, "find_spec", lambda name: name)
    assert services.slurm_line().verdict == ("ok" if kind == "answers" else "look")


def test_programs_that_are_not_here(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(services, "find_spec", lambda name: None)
    assert services.slurm_line() == Line("SLURM", "not here; only sag sweep --slurm needs it")
    lines = {line.name: line for line in services.program_lines()}
    assert {name: line.verdict for name, line in lines.items()} == {
        "make": "look",
        "git": "look",
        "browser": "",
        "ffmpeg": "",
    }
    assert "sag sweep sweeps/ablation.yaml" in lines["make"].details[0]
