"""A short form of `make chaos`: fits that are killed or asked to end go on as if nothing had been."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from chaos import ROOT, TinySweep

ENVIRONMENT = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}", "WANDB_MODE": "offline"}


def started(sweep: TinySweep, run: Path, *options: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "sag", "fit", "--config", "configs/base.yaml", "--config"]
    command += [str(sweep.folder / "tiny.yaml"), f"--trainer.default_root_dir={run}", "--trainer.logger=false"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    return subprocess.Popen([*command, *options], cwd=ROOT, env=ENVIRONMENT, **pipes)


def hit(process: subprocess.Popen[str], run: Path, after: int, sent: signal.Signals) -> tuple[int, str, float]:
    """Status, last words and seconds of a fit that gets a signal after so many batches."""
    deadline = time.monotonic() + 120
    while not (run / "progress.json").is_file() or json.loads((run / "progress.json").read_text())["step"] < after:
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    began = time.monotonic()
    process.send_signal(sent)
    said, _ = process.communicate(timeout=60)
    return process.returncode, said, time.monotonic() - began


@pytest.mark.slow
def test_a_fit_goes_on_after_sigterm_and_sigkill(tmp_path: Path) -> None:
    import torch

    sweep = TinySweep(tmp_path, ("m",), epochs=20)
    whole, hurt = tmp_path / "whole", tmp_path / "hurt"
    said, _ = started(sweep, whole).communicate(timeout=200)
    assert (whole / "checkpoints/last.ckpt").is_file(), said
    status, said, seconds = hit(started(sweep, hurt), hurt, 1, signal.SIGTERM)
    assert status == 128 + signal.SIGTERM and seconds < 10
    assert "sag: SIGTERM: ended after epoch" in said and "--ckpt_path last goes on" in said
    status, said, _ = hit(started(sweep, hurt, "--ckpt_path=last"), hurt, 2, signal.SIGKILL)
    assert status == -signal.SIGKILL
    said, _ = started(sweep, hurt, "--ckpt_path=last").communicate(timeout=200)
    assert "training goes on from" in said
    one, other = (torch.load(run / "checkpoints/last.ckpt", weights_only=True) for run in (whole, hurt))
    assert all(torch.equal(value, other["state_dict"][name]) for name, value in one["state_dict"].items())
    assert one["global_step"] == other["global_step"] and not sweep.strays()
