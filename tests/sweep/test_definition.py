from pathlib import Path

import pytest
import yaml

from sag.errors import SagError
from sag.letters import LETTERS
from sag.sweep.command import Additions
from sag.sweep.definition import read_sweep
from sag.sweep.rows import plan

SWEEPS = Path(__file__).parents[2] / "sweeps"


def sweep_file(folder: Path, text: str) -> Path:
    path = folder / "sweep.yaml"
    path.write_text(text)
    return path


def test_the_grid_is_every_combination_and_the_last_parameter_changes_fastest(tmp_path):
    sweep = read_sweep(
        sweep_file(tmp_path, "{program: p, parameters: {a: {values: [1, 2]}, b: {value: x}, c: {values: [3, 4]}}}")
    )
    assert sweep.points() == [{"a": a, "b": "x", "c": c} for a in (1, 2) for c in (3, 4)]
    assert sweep.varied == ["a", "c"]
    assert sweep.name == "sweep"
    assert sweep.command == ("${env}", "${interpreter}", "${program}", "${args}")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{program: p, method: bayes, parameters: {a: {value: 1}}}", "method 'bayes'"),
        ("{program: p, parameters: {a: {min: 0, max: 1}}}", "parameter 'a'"),
        ("{program: p, parameters: {a: {values: []}}}", "parameter 'a'"),
        ("{program: p, parameters: {}}", "'parameters'"),
        ("{program: p}", "'parameters'"),
        ("{program: p, paramters: {}}", "'paramters'"),
        ("{parameters: {a: {value: 1}}}", "'program'"),
        ("[1, 2]", "mapping"),
        ("{a: [", "not valid YAML"),
    ],
)
def test_what_is_not_run_here_is_refused_in_one_sentence_that_names_the_file(tmp_path, text, sentence):
    path = sweep_file(tmp_path, text)
    with pytest.raises(SagError, match=sentence) as error:
        read_sweep(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(SagError, match=r"nowhere\.yaml does not exist"):
        read_sweep(tmp_path / "nowhere.yaml")


def test_the_ablation_is_the_grid_of_the_four_components():
    sweep = read_sweep(SWEEPS / "ablation.yaml")
    assert list(sweep.parameters) == [f"components.{name}" for name in LETTERS]
    assert len({tuple(point.values()) for point in sweep.points()}) == 16


def test_table_1_is_the_papers_six_rows(tmp_path, monkeypatch):
    sweep = read_sweep(SWEEPS / "table1.yaml")
    for config in [*sweep.parameters["config"].values, *(p for p in sweep.command if p.endswith(".yaml"))]:
        (tmp_path / config).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / config).touch()
    for method in ("erd", "ground_truth", "blind"):
        (tmp_path / "configs/methods").mkdir(parents=True, exist_ok=True)
        (tmp_path / f"configs/methods/{method}.yaml").touch()
    monkeypatch.chdir(tmp_path)
    names = [row.name for row in plan(sweep, Additions())]
    assert names == ["encoders", "ground_truth", "none", "m", "md", "mdc", "mdp", "mdpc", "blind"]


@pytest.mark.parametrize(
    ("table", "metric", "goal"),
    [("table3", "test/motion_fid/average", "minimize"), ("table4", "test/non_collision/average", "maximize")],
)
def test_wandb_is_told_the_figure_that_the_table_is_of(table, metric, goal):
    assert yaml.safe_load((SWEEPS / f"{table}.yaml").read_text())["metric"] == {"name": metric, "goal": goal}


@pytest.mark.parametrize("path", sorted(SWEEPS.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_sweep_file_holds_what_wandb_sweep_asks_for(path):
    content = yaml.safe_load(path.read_text())
    assert {"program", "name", "method", "metric", "command", "parameters"} <= set(content)
    assert content["command"][:4] == ["${env}", "${interpreter}", "-m", "sag"]
    assert content["command"][-1] == "${args}"


def test_wandb_itself_expands_the_command_as_we_do(tmp_path, monkeypatch):
    agent = pytest.importorskip("wandb.sdk.launch.sweeps.utils")
    from sag.sweep.command import row_command

    sweep = read_sweep(sweep_file(tmp_path, "{program: p.py, parameters: {a: {value: 1.5}, b: {value: text}}}"))
    point = sweep.points()[0]
    theirs = agent.create_sweep_command_args({"args": {k: {"value": v} for k, v in point.items()}})
    assert row_command(sweep, point, Additions())[-2:] == theirs["args"]
