"""Data of one's own with another skeleton, from the command line: encoders, training, test, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from folder_files import SKELETON, write_root, write_skeleton

from sag.cli import main
from sag.methods import SAG

CONFIGS = Path(__file__).parents[2] / "configs"
ENCODERS = ["--config", str(CONFIGS / "methods/erd.yaml")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Where everything lies: the data, their cache, and what is trained on them."""
    made = tmp_path_factory.mktemp("own")
    write_root(made / "mine")
    small = {
        "model": {"init_args": {"network": {"width": 0.05}}},
        "encoder_width": 0.05,
        "data": {"init_args": {"cache_dir": str(made / "cache"), "image_size": [36, 64], "stride": 1}},
        "trainer": {"max_epochs": 1, "default_root_dir": str(made / "run"), "accelerator": "cpu"},
    }
    (made / "small.yaml").write_text(yaml.safe_dump(small))
    return made


def options(folder: Path) -> list[str]:
    """As the guide has them, with small networks."""
    names = (CONFIGS / "base.yaml", CONFIGS / "presets/quick.yaml", CONFIGS / "data/folder.yaml", folder / "small.yaml")
    configs = [part for name in names for part in ("--config", str(name))]
    mine = folder / "mine"
    return [*configs, "--data.init_args.root", str(mine), "--data.init_args.skeleton", str(mine / "skeleton.yaml")]


@pytest.fixture(scope="module")
def run(folder) -> Path:
    """A run whose encoders, network and figures are of the 17 joints."""
    width = ["--model.init_args.width", "0.05"]
    assert main(["fit", *options(folder), *ENCODERS, *width, "--trainer.default_root_dir", str(folder / "erd")]) == 0
    assert main(["run", *options(folder)]) == 0
    return folder / "run"


def test_a_run_on_17_joints_has_every_figure(run):
    found = json.loads((run / "metrics.json").read_text())
    assert found["protocol"]["skeleton"] == "h36m_17" and found["protocol"]["motions"] == 6
    for name in ("motion_fid/average", "non_collision/average", "foot_skate", "floor/error", "depth_error/rmse"):
        assert np.isfinite(found["metrics"][name])


def test_predictions_are_of_17_joints_and_are_scored(run, folder, capsys):
    checkpoint = ["--ckpt_path", str(run / "checkpoints/last.ckpt")]
    assert main(["predict", *options(folder), *checkpoint]) == 0
    with np.load(run / "predictions.npz") as predicted:
        assert predicted["joints"].shape == (6, 5, 65, 17, 3) and str(predicted["skeleton"]) == "h36m_17"
    capsys.readouterr()
    reference = ["--reference", "folder", "--data.init_args.root", str(folder / "mine"), "--data.init_args.stride", "1"]
    small = ["--data.init_args.cache_dir", str(folder / "cache"), "--data.init_args.image_size", "[36,64]"]
    scores = folder / "scores.json"
    assert main(["score", str(run / "predictions.npz"), *reference, *small, "--out", str(scores)]) == 0
    trained = json.loads((run / "metrics.json").read_text())["metrics"]
    assert json.loads(scores.read_text())["metrics"]["foot_skate"] == trained["foot_skate"]


@pytest.mark.parametrize("stage", ["fit", "validate", "test", "predict"])
@pytest.mark.parametrize("method", [[], ENCODERS], ids=["sag", "erd"])
def test_every_stage_runs(folder, stage, method):
    if method and stage == "predict":
        pytest.skip("encoders do not make motions")
    dry = ["--trainer.fast_dev_run", "true", "--trainer.default_root_dir", str(folder / "dry")]
    assert main([stage, *options(folder), *method, *dry]) == 0


def refused(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    """What the one line says of a refused command."""
    assert main(arguments) == 2
    (said,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("sag: ")]
    return said


def test_a_checkpoint_for_another_skeleton_is_refused(run, folder, capsys):
    joints = [name for name in SKELETON["joints"] if name != "nose"]
    bones = [*(bone for bone in SKELETON["bones"] if "nose" not in bone), ["thorax", "head"]]
    parts = {**SKELETON["parts"], "head": ["head"]}
    write_skeleton(folder / "fewer", name="without_nose", joints=joints, bones=bones, parts=parts)
    other = ["--data.init_args.skeleton", str(folder / "fewer/skeleton.yaml"), "--trainer.fast_dev_run", "true"]
    said = refused(capsys, ["test", *options(folder), *other, "--ckpt_path", str(run / "checkpoints/last.ckpt")])
    assert "h36m_17 (17 joints)" in said and "without_nose (16 joints)" in said
    said = refused(capsys, ["fit", *options(folder), *other, "--pretrained", str(run / "checkpoints/last.ckpt")])
    assert "h36m_17 (17 joints)" in said and "without_nose (16 joints)" in said


def test_what_a_data_set_refuses_is_one_line(folder, tmp_path, capsys):
    said = refused(capsys, ["fit", *options(folder), "--data.init_args.root", str(tmp_path)])
    assert "has no skeleton.yaml" in said and "docs/own-data.md" in said
    said = refused(capsys, ["fit", *options(folder), "--data.init_args.skeleton", "prox_16"])
    assert "prox_16 has joints that" in said and "lacks: chest" in said
    said = refused(capsys, ["fit", *options(folder), "--data.init_args.stride", "0"])
    assert "data.init_args.stride" in said
    score = ["score", "nothing.npz", "--reference", "folder", "--data.init_args.root", str(tmp_path)]
    assert "has no skeleton.yaml" in refused(capsys, score)


def test_the_methods_learn_the_skeleton_of_the_data(folder, monkeypatch):
    names: list[str] = []
    monkeypatch.setattr(SAG, "on_fit_start", lambda method: names.append(method.skeleton.name))
    dry = ["--trainer.fast_dev_run", "true", "--trainer.default_root_dir", str(folder / "dry")]
    assert main(["fit", *options(folder), *dry]) == 0
    assert names == ["h36m_17"]
