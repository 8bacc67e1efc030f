"""The run that ships: small, whole, what commands use where none is named, and its figures come out again."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from sag.checkpoints import LAST, WholeCheckpoints
from sag.cli import main
from sag.runs import CHECKPOINT, read_run
from sag.shipped import FOLDER, beside, run_path

ROOT = Path(__file__).parent.parent
CONFIGS = ["base", "presets/quick", "methods/erd"]
OF_ENCODERS = ("motion_fid", "motion_kid", "multimodality")
"""Figures that rest on encoders, which each machine trains for itself."""


def test_it_is_small_and_has_its_card_config_and_figures():
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) < 10e6
    assert {path.name for path in FOLDER.iterdir()} == {"README.md", "config.fit.yaml", "metrics.json", "checkpoints"}
    assert [path.name for path in (FOLDER / "checkpoints").iterdir()] == [LAST]
    assert WholeCheckpoints().load_checkpoint(FOLDER / CHECKPOINT)["optimizer_states"] == []


def test_its_name_is_a_path_unless_something_is_called_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_path("shipped") == FOLDER and run_path("runs/a") == Path("runs/a")
    Path("shipped").mkdir()
    assert run_path("shipped") == Path("shipped")


def test_nothing_is_written_beside_it():
    assert beside(FOLDER, "view.html") == Path("view.html")
    assert beside(Path("runs/a"), "view.html") == Path("runs/a/view.html")


def test_a_photograph_needs_no_run_and_no_rooms(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    grey = np.random.default_rng(0).integers(60, 190, (180, 320, 3), dtype=np.uint8)
    Image.fromarray(grey).save("room.png")
    photo = ["--image", "room.png", "--fov", "55", "--start", "160,90", "--samples", "2", "--output", "walk"]
    assert main(["sample", *photo]) == 0
    assert np.load("walk/motions.npz")["joints"].shape == (1, 2, 65, 19, 3)
    assert not Path("data").exists(), "rooms were built"


def test_it_keeps_bones_and_moves():
    run = read_run(FOLDER)
    scale = run.method.sampler.scale
    assert run.method.generator_steps > 1000
    assert 0.02 < scale.speed_limit < 0.2 and not torch.equal(scale.pose_std, torch.ones_like(scale.pose_std))


def command(folder: Path, *arguments: str) -> None:
    environment = {**os.environ, "WANDB_MODE": "offline", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "sag", *arguments], cwd=folder, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.slow
def test_its_figures_come_out_again(tmp_path: Path):
    """On rooms built here, which another processor rounds otherwise; Motion FID's encoders are trained here too."""
    command(tmp_path, "fit", *(f"--config={ROOT / 'configs' / name}.yaml" for name in CONFIGS))
    options = [f"--config={FOLDER / 'config.fit.yaml'}", f"--ckpt_path={FOLDER / CHECKPOINT}"]
    command(tmp_path, "test", *options, f"--trainer.default_root_dir={tmp_path / 'again'}")
    kept, found = (json.loads((place / "metrics.json").read_text()) for place in (FOLDER, tmp_path / "again"))
    assert kept["protocol"]["motions"] == found["protocol"]["motions"] == 873
    assert kept["metrics"].keys() == found["metrics"].keys()
    for name, value in kept["metrics"].items():
        rough = any(part in name for part in OF_ENCODERS)
        assert found["metrics"][name] == pytest.approx(value, rel=0.3 if rough else 0.05, abs=1e-3), name
