"""Every YAML in configs/ is a run: it fits, tests and predicts, laid over the base as the README says."""

import dataclasses
import inspect
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

import sag.methods
from sag.cli import main

ROOT = Path(__file__).parent.parent
CONFIGS = ROOT / "configs"
STRATEGIES = sorted((CONFIGS / "strategy").glob("*.yaml"))  # run in tests/test_strategies.py, in processes of their own
OVERLAYS = set(CONFIGS.rglob("*.yaml")) - {CONFIGS / "base.yaml", *STRATEGIES}
ALL = sorted(str(p.relative_to(CONFIGS)) for p in OVERLAYS)
ROWS = sorted((CONFIGS / "ablations").glob("*.yaml"))
WITHOUT_SIZES = ("methods/erd.yaml", "methods/ground_truth.yaml")

TINY = """
model: {init_args: {network: {width: 0.05}}}
data:
  class_path: toy_data.ToyDataModule
  init_args: {cache_dir: CACHE, skeleton: gta_im_19, image_size: [36, 64], batch_size: 4}
trainer: {fast_dev_run: true, default_root_dir: RUN, accelerator: cpu}
"""

WITHOUT_NETWORK = TINY.replace("model: {init_args: {network: {width: 0.05}}}", "")


def command(stage: str, name: str, folder: Path, cache: Path) -> list[str]:
    """A command that lays one config, and then tiny data, over the base."""
    text = WITHOUT_NETWORK if name in WITHOUT_SIZES else TINY
    tiny = folder / "tiny.yaml"
    tiny.write_text(text.replace("CACHE", str(cache)).replace("RUN", str(folder)))
    configs = [CONFIGS / "base.yaml", CONFIGS / name, tiny]
    options = ["--encoder_width", "0.05"]
    if stage == "fit" and "scene_encoder:" in (CONFIGS / name).read_text():
        options += ["--model.init_args.network.scene_encoder", "null"]  # another run's, with other sizes
    return [stage, *(part for path in configs for part in ("--config", str(path))), *options]


@pytest.mark.parametrize("stage", ["fit", "test", "predict"])
@pytest.mark.parametrize("name", ALL)
def test_every_config_runs(name: str, stage: str, tmp_path: Path, toy_cache: Path) -> None:
    if name == "methods/ground_truth.yaml" and stage == "fit":
        pytest.skip("ground truth has nothing to fit")
    if name == "methods/erd.yaml" and stage == "predict":
        pytest.skip("encoders do not make motions")
    assert main(command(stage, name, tmp_path, toy_cache)) == 0


def recipe_of(name: str) -> Any:
    """The recipe that the method of a config has by default, if it has one."""
    kind = yaml.safe_load((CONFIGS / name).read_text()).get("model", {}).get("class_path", "")
    parameters = inspect.signature(getattr(sag.methods, kind.rpartition(".")[2], object)).parameters
    return parameters["recipe"].default if "recipe" in parameters else None


@pytest.mark.parametrize("preset", ["quick", "paper"])
@pytest.mark.parametrize("name", [name for name in ALL if recipe_of(name)])
def test_presets_scale_a_baseline_and_leave_its_recipe(
    name: str, preset: str, capsys: pytest.CaptureFixture[str]
) -> None:
    layers = ["base.yaml", f"presets/{preset}.yaml", "data/rooms.yaml", name]
    with pytest.raises(SystemExit):
        main(["fit", *(f"--config={CONFIGS / layer}" for layer in layers), "--print_config"])
    found = yaml.safe_load(capsys.readouterr().out)["model"]["init_args"]
    assert found["recipe"] == json.loads(json.dumps(dataclasses.asdict(recipe_of(name))))
    assert found["network"]["width"] == {"quick": 0.25, "paper": 1.0}[preset]
    assert set(found) == {"network", "recipe", "evaluation"}


@pytest.mark.parametrize("path", ROWS, ids=lambda p: p.stem)
def test_a_row_is_four_booleans_and_its_name(path: Path) -> None:
    from sag.components import Components

    content = yaml.safe_load(path.read_text())
    assert list(content) == ["components"]
    assert Components(**content["components"]).letters == "".join(c for c in "mdpc" if c in path.stem) or path.stem
    assert all(type(v) is bool for v in content["components"].values())
    assert len(content["components"]) == 4


def test_the_base_says_what_it_is() -> None:
    text = (CONFIGS / "base.yaml").read_text()
    assert "critic_norm: batch" in text
    assert "penalty_target: 0.1" in text
    assert "max_epochs: 150" in text


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
@pytest.mark.parametrize(("target", "rooms"), [("recipe", "other_rooms"), ("ablation", "rooms"), ("table1", "rooms")])
def test_settings_are_chosen_in_rooms_that_no_table_is_tested_on(target, rooms):
    said = subprocess.run(["make", "--dry-run", target], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert set(re.findall(r"configs/data/(\w+)\.yaml", said)) == {rooms}
