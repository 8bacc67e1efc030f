"""The strategies in configs/strategy: what they ask for, and a command that starts its own processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import torch
import yaml
from toy_data import ToyDataModule

from sag.cli import main
from sag.models.erd import MotionEncoders

ROOT = Path(__file__).parent.parent
CONFIGS = ROOT / "configs"
STRATEGIES = sorted((CONFIGS / "strategy").glob("*.yaml"))


@pytest.mark.parametrize("path", STRATEGIES, ids=lambda p: p.stem)
def test_a_strategy_says_all_that_another_could_have_said(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    layers = [CONFIGS / "base.yaml", CONFIGS / "strategy/ddp_nodes.yaml", path]
    with pytest.raises(SystemExit):
        main(["run", *(f"--config={layer}" for layer in layers), "--print_config"])
    found = yaml.safe_load(capsys.readouterr().out)["trainer"]
    wanted = yaml.safe_load(path.read_text())["trainer"]
    assert {name: found[name] for name in wanted} == wanted
    assert wanted.keys() >= {"accelerator", "devices", "num_nodes", "strategy"}
    assert wanted["strategy"] in ("auto", "ddp_find_unused_parameters_true")


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    """A command of two processes on toy data of twelve training and six test windows."""
    data = ToyDataModule(tmp_path / "data", windows=12)
    torch.manual_seed(0)
    MotionEncoders("gta_im_19", width=0.02).save(data.encoder_path, data.cache.fingerprint)
    tiny = tmp_path / "tiny.yaml"
    tiny.write_text(
        f"""
encoder_width: 0.02
model: {{init_args: {{network: {{width: 0.05, critic_norm: layer}}, evaluation: {{samples: 2, resamples: 10}}}}}}
data:
  class_path: toy_data.ToyDataModule
  init_args: {{cache_dir: {tmp_path}/data, image_size: [36, 64], batch_size: 4, eval_batch_size: 2, windows: 12}}
trainer: {{max_epochs: 1, default_root_dir: {tmp_path}/run, enable_progress_bar: false}}
"""
    )
    layers = [CONFIGS / "base.yaml", CONFIGS / "strategy/ddp_cpu.yaml", tiny]
    return [sys.executable, "-m", "sag", "run", *(f"--config={layer}" for layer in layers)]


def run(command: list[str]) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}/tests", "OMP_NUM_THREADS": "1"}
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600)


@pytest.mark.slow
def test_a_command_of_two_processes_leaves_what_one_leaves(command: list[str], tmp_path: Path) -> None:
    done = run(command)
    assert done.returncode == 0, done.stderr
    assert "MEMBER: 2/2" in done.stderr and "sync_dist" not in done.stderr
    assert done.stdout.count("the figures are in") == done.stdout.count("the checkpoint is") == 1
    left = {str(p.relative_to(tmp_path / "run")) for p in (tmp_path / "run").rglob("*") if p.is_file()}
    ours = {name for name in left if not name.startswith("wandb")}
    assert ours == {"metrics.json", "progress.json", "config.fit.yaml", "checkpoints/last.ckpt", "samples.png"}
    assert len([name for name in left if name.endswith(".wandb")]) == 1
    found = json.loads((tmp_path / "run/metrics.json").read_text())
    assert found["protocol"]["motions"] == 6 and found["steps"] == 3


@pytest.mark.slow
def test_what_is_wrong_is_said_once_with_the_status_of_one_process(command: list[str]) -> None:
    done = run([*command, "--trainer.loss_limit=1e-9"])
    assert done.returncode == 3
    (sentence,) = (line for line in done.stderr.splitlines() if line.startswith("sag: "))
    assert "beyond trainer.loss_limit" in sentence and "Traceback" not in done.stderr
