"""`sag extend`: what it writes and prints, that it is the same every time, and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
import torch
import yaml

from sag.cli import main
from sag.methods import SAG


@pytest.fixture
def run(tmp_path: Path, toy) -> Path:
    """The folder of a run that was trained for nothing but its normalisation."""
    network = {"width": 0.05, "critic_norm": "layer"}
    config = {
        "components": {"projection": False, "context": False},
        "model": {"class_path": "sag.methods.SAG", "init_args": {"network": network}},
        "data": {"class_path": "toy_data.ToyDataModule", "init_args": {"cache_dir": str(toy.cache_dir)}},
    }
    (tmp_path / "config.fit.yaml").write_text(yaml.safe_dump(config))
    folder = tmp_path / "checkpoints"
    folder.mkdir()
    torch.save({"state_dict": _state(config, toy)}, folder / "last.ckpt")
    return tmp_path


def _state(config: dict, toy) -> dict[str, torch.Tensor]:
    from sag.components import Components, Network

    network = Network(**config["model"]["init_args"]["network"])
    method = SAG(Components(**config["components"]), network, image_size=toy.image_size)
    method.sampler.scale.fit(toy.training_motion)
    method.generator_steps += 1
    return method.state_dict()


def extended(run: Path, *options: str) -> dict[str, np.ndarray]:
    assert main(["extend", str(run), "--windows", "3", *options]) == 0
    with np.load(run / "extended.npz") as file:
        return dict(file)


def test_writes_motions_and_prints_their_seams(run, toy, capsys):
    found = extended(run, "--frames", "130", "--samples", "2")
    said = capsys.readouterr().out
    assert found["joints"].shape == (3, 2, 130, 19, 3) and np.isfinite(found["joints"]).all()
    assert not np.allclose(found["joints"][:, 0], found["joints"][:, 1])
    truth = toy.cache.joints[found["index"]][:, None, 0]
    assert np.allclose(found["joints"][:, :, 0], truth, atol=1e-5)
    assert found["fps"] == 30 and found["skeleton"] == "gta_im_19"
    for words in ("recorded", "plain seams", "blended over 8", f"are in {run / 'extended.npz'}", "3 test windows"):
        assert words in said


def test_one_seed_gives_one_file(run):
    first, again = (extended(run, "--frames", "100")["joints"] for _ in range(2))
    other = extended(run, "--frames", "100", "--seed", "1")["joints"]
    assert np.array_equal(first, again) and not np.allclose(first, other)


def test_one_window_has_no_seams(run, capsys):
    assert extended(run, "--frames", "65")["joints"].shape == (3, 1, 65, 19, 3)
    said = capsys.readouterr().out
    assert "one window" in said and "plain" not in said


REFUSALS = {
    "frames": (["--frames", "64"], "one window alone has 65"),
    "overlap": (["--frames", "100", "--overlap", "40"], "choose an overlap of 1 to 32"),
    "samples": (["--frames", "100", "--samples", "0"], "--samples is 0"),
    "windows": (["--frames", "100", "--windows", "1000"], "--windows is 1000"),
    "out": (["--frames", "100", "--out", "motions.csv"], "--out motions.csv must be a file that ends in .npz"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, run, capsys):
    options, said = REFUSALS[name]
    assert main(["extend", str(run), *options]) == 2
    assert said in capsys.readouterr().err
    assert not (run / "extended.npz").exists()


def test_refuses_a_folder_without_a_run(tmp_path, capsys):
    assert main(["extend", str(tmp_path), "--frames", "100"]) == 2
    assert "holds neither a run" in capsys.readouterr().err


def test_score_says_that_it_reads_single_windows(run, capsys):
    extended(run, "--frames", "100")
    assert main(["score", str(run / "extended.npz"), "--reference", str(run / "config.fit.yaml")]) == 2
    assert "65" in capsys.readouterr().err
