"""A run made small samples what the run samples, and holds nothing of its training."""

from pathlib import Path

import pytest
import torch
from toy_runs import toy_run

from sag.checkpoints import WholeCheckpoints
from sag.errors import SagError
from sag.runs import read_run
from sag.slim import main, slimmed


def checkpoint(averaged: bool) -> dict:
    """A checkpoint whose average differs from its weights."""
    state = {"sampler.w": torch.zeros(2), "critics.pose.w": torch.ones(1)}
    if averaged:
        state |= {"averaged.0.module.w": torch.ones(2), "averaged.0.n_averaged": torch.tensor(7)}
    return {"state_dict": state, "optimizer_states": [{"exp_avg": torch.ones(9)}], "skeleton": "s", "global_step": 3}


def test_the_average_takes_the_place_of_the_weights():
    small = slimmed(checkpoint(averaged=True))
    assert set(small["state_dict"]) == {"sampler.w", "critics.pose.w"}
    assert torch.equal(small["state_dict"]["sampler.w"], torch.ones(2))
    assert small["optimizer_states"] == [] and small["global_step"] == 3
    assert "loops" not in small, "a test would look in them for its own"


def test_without_an_average_the_weights_stay():
    assert torch.equal(slimmed(checkpoint(averaged=False))["state_dict"]["sampler.w"], torch.zeros(2))


@pytest.mark.parametrize("average", [0.0, 0.9])
def test_a_small_run_samples_what_the_run_samples(average: float, toy, tmp_path: Path, capsys):
    trained_run = toy_run(tmp_path / "run", toy, average=average)
    assert main([str(trained_run), "--out", str(tmp_path / "small")]) == 0
    before, after = read_run(trained_run), read_run(tmp_path / "small")
    (batch, *_) = before.windows(2)
    motions = [run.method.sample(batch, torch.Generator().manual_seed(1)).joints for run in (before, after)]
    assert torch.equal(*motions)
    raw = before.method.sampler.generator.state_dict()
    same = all(torch.equal(w, after.method.sampler.generator.state_dict()[n]) for n, w in raw.items())
    assert same == (average == 0)
    assert " MB before" in capsys.readouterr().out
    small = WholeCheckpoints().load_checkpoint(tmp_path / "small/checkpoints/last.ckpt")
    assert not small["optimizer_states"]
    with pytest.raises(SagError, match="is there already"):
        main([str(trained_run), "--out", str(tmp_path / "small")])


def test_a_folder_without_a_run_is_refused(tmp_path: Path):
    with pytest.raises(SagError, match="holds no run"):
        main([str(tmp_path), "--out", str(tmp_path / "small")])
    assert not (tmp_path / "small").exists()
