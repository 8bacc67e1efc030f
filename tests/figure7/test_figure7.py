"""The command, on runs that were trained a moment ago."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from sag.cli import main
from sag.errors import SagError
from sag.runs import read_runs

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory, toy_cache: Path) -> Path:
    """A folder with a trained SAG and a trained Cao, as a sweep leaves them."""
    folder = tmp_path_factory.mktemp("figure7")
    for name, config in (("mdpc", "ablations/mdpc.yaml"), ("cao", "methods/cao.yaml")):
        tiny = folder / f"{name}.yaml"
        tiny.write_text(
            f"""
model: {{init_args: {{network: {{width: 0.05}}}}}}
data:
  class_path: toy_data.ToyDataModule
  init_args: {{cache_dir: {toy_cache}, image_size: [36, 64], batch_size: 4}}
trainer:
  max_epochs: 3
  default_root_dir: {folder / name}
  accelerator: cpu
  logger: false
  enable_progress_bar: false
"""
        )
        options = [part for path in ("base.yaml", config) for part in ("--config", str(CONFIGS / path))]
        assert main(["fit", *options, "--config", str(tiny)]) == 0
        (folder / name / "metrics.json").write_text("{}")
    return folder


def figure(*arguments: object) -> int:
    return main(["figure7", *map(str, arguments)])


def test_a_figure_of_two_runs(sweep: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert figure(sweep / "cao", sweep / "mdpc", "--out", tmp_path, "--windows", 4, "--samples", 7) == 0
    said = capsys.readouterr().out
    assert "mdpc" in said and "cao" in said and "end off by" in said
    content = json.loads((tmp_path / "figure7.json").read_text())
    assert [content[key] for key in ("windows", "samples", "trajectories", "seed")] == [4, 7, 5, 0]
    drawn, told = content["methods"]
    assert (drawn["run"], told["run"]) == ("mdpc", "cao")
    assert not any(told["deviation"]) and told["largest"] == 0
    assert drawn["deviation"][0] == 0 and min(drawn["deviation"][1:]) > 0
    assert 0 < drawn["end_off_by"]["median"] <= drawn["end_off_by"]["max"]
    lines = list(csv.reader((tmp_path / "figure7.csv").open()))
    assert lines[0] == ["frame", "seconds", "mdpc", "cao"]
    assert len(lines) == 66 and {line[3] for line in lines[1:]} == {"0"}
    assert (tmp_path / "figure7.png").read_bytes().startswith(b"\x89PNG")


def test_a_sweeps_folder_stands_for_its_rows(sweep: Path) -> None:
    runs = read_runs([sweep])
    assert [run.name for run in runs] == ["cao", "mdpc"]
    assert all(run.method.trained and not run.method.training for run in runs)


def test_weights_are_those_of_the_checkpoint(sweep: Path) -> None:
    import torch

    (run,) = read_runs([sweep / "cao"])
    saved = torch.load(sweep / "cao/checkpoints/last.ckpt", weights_only=True)["state_dict"]
    assert all(torch.equal(value, saved[name]) for name, value in run.method.state_dict().items())


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    assert figure(*arguments) == 2
    return capsys.readouterr().err


def test_mistakes_are_named(sweep: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = ("--out", tmp_path / "out")
    assert "two of the runs are called 'cao'" in refusal(capsys, sweep / "cao", sweep / "cao", *out)
    assert "neither a run" in refusal(capsys, tmp_path, *out)
    assert "--windows is 99" in refusal(capsys, sweep / "mdpc", *out, "--windows", 99)
    assert "--end true" in refusal(capsys, sweep / "cao", *out, "--windows", 2)
    assert "is a file" in refusal(capsys, sweep / "cao", "--out", sweep / "cao/metrics.json")
    assert not (tmp_path / "out").exists()


@pytest.fixture
def copied(sweep: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(sweep / "mdpc", tmp_path / "copied"))


def changed(folder: Path, old: str, new: str) -> None:
    path = folder / "config.fit.yaml"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


def test_a_config_of_another_version_is_named(copied: Path) -> None:
    changed(copied, "critic_steps: 1", "critic_stepps: 1")
    with pytest.raises(SagError, match=r"config\.fit\.yaml is not of this version.*critic_stepps"):
        read_runs([copied])


def test_a_checkpoint_of_other_sizes_is_named(copied: Path) -> None:
    changed(copied, "width: 0.05", "width: 0.3")
    with pytest.raises(SagError, match="does not fit this SAG"):
        read_runs([copied])


def test_runs_on_other_data_do_not_stand_in_one_figure(sweep: Path, copied: Path) -> None:
    changed(copied, "windows: 8", "windows: 10")
    with pytest.raises(SagError, match=r"cao and copied cannot stand in one figure"):
        read_runs([sweep / "cao", copied])


def test_a_moved_cache_is_found(copied: Path, toy_cache: Path, tmp_path: Path) -> None:
    changed(copied, str(toy_cache), str(tmp_path / "nowhere"))
    (run,) = read_runs([copied], toy_cache)
    assert run.data.cache_dir == toy_cache


def test_a_missing_checkpoint_is_named(copied: Path) -> None:
    (copied / "checkpoints/last.ckpt").unlink()
    with pytest.raises(SagError, match=r"last\.ckpt is no file"):
        read_runs([copied])
