"""`sag figure speeds`: who stands and who walks, beside the recorded motions."""

from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from toy_runs import toy_run

from sag.cli import main
from sag.figures.speeds import speeds, summary


def test_speed_is_that_of_the_root():
    walk = torch.zeros(2, 65, 3)
    walk[0, :, 2] = torch.arange(65) * 0.04
    assert speeds(walk, fps=30) == pytest.approx([1.2, 0])


def test_a_row_that_never_stands_shows():
    truth, walks = np.array([0.0, 0.05, 1.0, 1.2]), np.array([1.0, 1.0, 1.0, 1.2])
    told = summary({"walks": walks, "recorded": truth}, truth).splitlines()
    assert told[1].split() == ["walks", "4", "0.0", "1.00", "0.487"]
    assert told[2].split() == ["recorded", "4", "50.0", "0.53", "0.000"]


def test_every_run_has_a_histogram(toy, tmp_path: Path, capsys):
    for name in ("a", "b"):
        toy_run(tmp_path / "sweep" / name, toy)
    out = tmp_path / "speeds.png"
    assert main(["figure", "speeds", str(tmp_path / "sweep"), "--samples", "2", "--out", str(out)]) == 0
    windows = len(toy.cache.rows("test"))
    lines = capsys.readouterr().out.splitlines()
    rows = {line.split()[0]: int(line.split()[1]) for line in lines[1:4]}
    assert rows == {"a": 2 * windows, "b": 2 * windows, "recorded": windows}
    assert Image.open(out).size[0] > 1000
