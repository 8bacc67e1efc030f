"""The command line: every mistake is one sentence that names it, and real runs leave what they promise."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from sag.cli import main
from sag.methods import SAG
from sag.parsing import one_sentence

CONFIGS = Path(__file__).parent.parent / "configs"


@pytest.fixture
def base(tmp_path: Path, toy_cache: Path) -> list[str]:
    """Options of a tiny run on toy data in a folder of its own."""
    tiny = tmp_path / "tiny.yaml"
    tiny.write_text(
        f"""
model: {{init_args: {{network: {{width: 0.05, critic_norm: layer}}, average: 0.9}}}}
encoder_width: 0.05
data:
  class_path: toy_data.ToyDataModule
  init_args: {{cache_dir: {toy_cache}, image_size: [36, 64], batch_size: 4}}
trainer: {{max_epochs: 2, default_root_dir: {tmp_path}/run, accelerator: cpu, enable_progress_bar: false}}
"""
    )
    return ["--config", str(CONFIGS / "base.yaml"), "--config", str(tiny)]


def sentence(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    """What a refused command says."""
    assert main(arguments) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("sag: ")]
    assert len(said) == 1
    return said[0]


REFUSALS = {
    "component": (["--components.projeciton", "true"], "projeciton", "projection"),
    "model option": (["--model.init_args.netwrk.width", "1"], "netwrk", "network"),
    "type": (["--model.init_args.network.width", "wide"], "width", "wide"),
    "abbreviation": (["--trainer.max_epoch", "3"], "max_epoch", "unrecognized"),
    "class": (["--model", "sag.methods.Nothing"], "Nothing", "sag.methods"),
    "file": (["--config", "nowhere.yaml"], "nowhere.yaml", "exist"),
    "data option": (["--data.init_args.roott", "x"], "roott", "cache_dir"),
    "norm": (["--model.init_args.network.critic_norm", "bach"], "critic_norm", "bach"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_a_mistake_is_named(name: str, base: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    options, wrong, hint = REFUSALS[name]
    said = sentence(capsys, ["fit", *base, *options])
    assert wrong in said
    assert hint in said
    assert len(said) < 300


def test_components_on_a_method_without_any(base: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    row = ["--config", str(CONFIGS / "methods/erd.yaml"), "--config", str(CONFIGS / "ablations/mdp.yaml")]
    assert "has no components" in sentence(capsys, ["fit", *base, *row])


def test_missing_data_is_named(base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    gta = ["--config", str(CONFIGS / "data/gta_im.yaml"), "--data.init_args.root", str(tmp_path / "nothing")]
    said = sentence(capsys, ["fit", *base[:2], *gta, "--trainer.default_root_dir", str(tmp_path / "run")])
    assert "nothing" in said
    assert "data.init_args.root" in said


def test_a_wrong_checkpoint_is_named(base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong = tmp_path / "wrong.ckpt"
    wrong.write_bytes(b"nothing of the kind")
    assert "wrong.ckpt" in sentence(capsys, ["test", *base, "--ckpt_path", str(wrong)])


@pytest.mark.parametrize(("typed", "meant"), [("fti", "fit"), ("sweeep", "sweep"), ("xyz", "--help")])
def test_a_mistyped_command(typed: str, meant: str, capsys: pytest.CaptureFixture[str]) -> None:
    said = sentence(capsys, [typed])
    assert typed in said
    assert meant in said


def test_help_and_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = capsys.readouterr().out
    for name in ("fit", "run", "validate", "test", "predict", "sweep", "report", "data"):
        assert f"  {name} " in shown
    assert main(["--version"]) == 0


def test_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "sag", "nothing"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("sag: there is no command 'nothing'")


def test_print_config_reads_back(base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["fit", *base, "--config", str(CONFIGS / "ablations/mdp.yaml"), "--print_config"])
    printed = capsys.readouterr().out
    again = tmp_path / "printed.yaml"
    again.write_text(printed)
    with pytest.raises(SystemExit):
        main(["fit", "--config", str(again), "--print_config"])
    assert capsys.readouterr().out == printed
    assert "context: false" in printed
    assert f"save_dir: {tmp_path}/run" in printed


def test_a_flag_overrules_what_interpolates_it(
    base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["fit", *base, "--trainer.default_root_dir", str(tmp_path / "elsewhere"), "--print_config"])
    assert f"save_dir: {tmp_path}/elsewhere" in capsys.readouterr().out


def test_a_real_run_leaves_everything(base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Encoders, then a run with W&B offline, then test and predict from its checkpoint."""
    encoders = ["--config", str(CONFIGS / "methods/erd.yaml"), "--model.init_args.retrain", "false"]
    folder = ["--trainer.default_root_dir", str(tmp_path / "encoders")]
    assert main(["fit", *base, *encoders, *folder]) == 0
    assert main(["run", *base]) == 0
    run = tmp_path / "run"
    metrics = json.loads((run / "metrics.json").read_text())
    assert metrics["row"] == "run"
    assert metrics["components"] == {"separate": True, "depth": True, "projection": True, "context": True}
    assert metrics["protocol"]["motions"] == 4
    assert metrics["protocol"]["encoders"]
    assert metrics["steps"] == 4
    wanted = {f"motion_fid/{name}" for name in ("short", "mid", "long", "average")}
    wanted |= {f"raw/{name}" for name in wanted} | {f"non_collision/{r}" for r in ("30", "45", "60", "average")}
    wanted |= {"velocity_frechet", "scene_frechet", "collisions/matched", "depth_error/rmse", "foot_skate", "jerk"}
    assert wanted <= set(metrics["metrics"])
    assert all(np.isfinite(metrics["metrics"][name]) for name in wanted)
    assert json.loads((run / "progress.json").read_text())["stage"] == "test"
    assert (run / "config.fit.yaml").is_file()
    assert list((run / "wandb").glob("offline-run-*/*.wandb")), "W&B kept its file offline"

    again = json.loads(json.dumps(metrics["metrics"]))
    checkpoint = ["--ckpt_path", str(run / "checkpoints/last.ckpt")]
    tested = ["--trainer.default_root_dir", str(tmp_path / "tested")]
    assert main(["test", *base, *tested, *checkpoint]) == 0
    assert json.loads((tmp_path / "tested/metrics.json").read_text())["metrics"] == again

    assert main(["predict", *base, *tested, *checkpoint, "--model.init_args.evaluation.samples", "3"]) == 0
    with np.load(tmp_path / "tested/predictions.npz", allow_pickle=False) as predicted:
        assert predicted["joints"].shape == (4, 3, 65, 19, 3)
        assert np.allclose(predicted["joints"][:, 0, 0], predicted["joints"][:, 1, 0])
        assert not np.allclose(predicted["joints"][:, 0, 9], predicted["joints"][:, 1, 9])
        assert str(predicted["skeleton"]) == "gta_im_19"

    assert main(["predict", *base, *tested, *checkpoint]) == 0
    scored = tmp_path / "scored.json"
    reference = ["--reference", str(run / "config.fit.yaml"), "--out", str(scored)]
    assert main(["score", str(tmp_path / "tested/predictions.npz"), *reference]) == 0
    found = json.loads(scored.read_text())
    same = {name for name in again if not name.startswith(("raw/", "depth_error/", "depth_probe/"))}
    assert {name: found["metrics"][name] for name in same} == {name: again[name] for name in same}
    assert found["ground_truth"]["motion_fid/average"] < 1e-9 < found["metrics"]["motion_fid/average"]
    assert found["protocol"] == metrics["protocol"]

    assert main(["validate", *base, *tested, *checkpoint]) == 0
    assert "val/motion_fid/average" in capsys.readouterr().out


def test_a_checkpoints_own_settings_do_not_overrule_flags(
    base: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["fit", *base]) == 0
    state = torch.load(tmp_path / "run/checkpoints/last.ckpt", weights_only=True)
    state["hyper_parameters"] = {"penalty": 3.0, "_class_path": "sag.methods.SAG"}
    torch.save(state, tmp_path / "with.ckpt")
    tested: list[float] = []
    monkeypatch.setattr(SAG, "on_test_end", lambda method: tested.append(method.recipe.penalty))
    options = ["--model.init_args.penalty", "7", "--trainer.default_root_dir", str(tmp_path / "tested")]
    dry = ["--trainer.fast_dev_run", "true", "--ckpt_path", str(tmp_path / "with.ckpt")]
    assert main(["test", *base, *options, *dry]) == 0
    assert tested == [7.0]


def test_missing_encoders_are_said_before_training(
    base: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fresh = ["--data.init_args.cache_dir", str(tmp_path / "cache")]
    assert "methods/erd.yaml" in sentence(capsys, ["run", *base, *fresh])
    assert not (tmp_path / "run/checkpoints").exists()


@pytest.mark.parametrize(
    ("message", "wanted"),
    [
        ("unrecognized arguments: --x", "unrecognized arguments: --x"),
        ('Parser key "seed":\n  Expected int', "--seed: Expected int"),
    ],
)
def test_plain_messages_stay(message: str, wanted: str) -> None:
    assert one_sentence(message) == wanted


def test_control_c_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    def interrupted(arguments: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("sag.cli._tool", lambda name: interrupted)
    assert main(["view", "runs/a"]) == 130
    assert capsys.readouterr().err == "sag: interrupted\n"
