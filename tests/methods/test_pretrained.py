"""Fine-tuning: a training that starts from the checkpoint of another."""

from pathlib import Path

import pytest
import torch
from test_sag import method, trained, trainer
from toy_data import ToyDataModule

from sag.cli import main
from sag.components import Components
from sag.errors import SagError
from sag.methods.pretrained import pretrained_state
from sag.skeleton import PROX_16

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture
def checkpoint(toy: ToyDataModule, tmp_path: Path) -> Path:
    """Of a short training with an average."""
    trained(toy, tmp_path, average=0.9).trainer.save_checkpoint(tmp_path / "before.ckpt")
    return tmp_path / "before.ckpt"


@pytest.fixture
def elsewhere(tmp_path: Path) -> ToyDataModule:
    """Other data: twice as many windows, so other statistics."""
    data = ToyDataModule(tmp_path / "elsewhere", windows=16)
    data.build()
    return data


def prepared(data: ToyDataModule, pretrained: Path, **options):
    made = starting(data, pretrained, **options)
    made.trainer = trainer(data.cache_dir)
    made.trainer.datamodule = data
    made.setup("fit")
    return made


def starting(data: ToyDataModule, pretrained: Path, **options):
    made = method(data, **options)
    made.pretrained = pretrained
    return made


def test_training_starts_from_the_weights_and_their_units(elsewhere, checkpoint) -> None:
    before = torch.load(checkpoint, weights_only=True)["state_dict"]
    state = prepared(elsewhere, checkpoint, average=0.9).state_dict()
    counters = {"generator_steps", "averaged.0.n_averaged"}
    assert all(torch.equal(state[name], before[name]) for name in before if name not in counters)
    fresh = method(elsewhere)
    fresh.trainer = trainer(elsewhere.cache_dir)
    fresh.prepare(elsewhere.training_motion)
    assert not torch.equal(fresh.sampler.scale.pose_mean, before["sampler.scale.pose_mean"])


def test_counters_start_anew(elsewhere, checkpoint) -> None:
    made = prepared(elsewhere, checkpoint, average=0.9)
    assert not made.trained
    assert (
        int(made.averaged[0].n_averaged)
        == 0
        < torch.load(checkpoint, weights_only=True)["state_dict"]["averaged.0.n_averaged"]
    )


def test_training_goes_on_from_there(elsewhere, checkpoint, tmp_path: Path) -> None:
    made = starting(elsewhere, checkpoint, average=0.9)
    trainer(tmp_path).fit(made, elsewhere)
    name = "sampler.generator.trajectory.out.weight"
    before, after = torch.load(checkpoint, weights_only=True)["state_dict"][name], made.state_dict()[name]
    start = method(elsewhere).state_dict()[name]
    assert made.trained
    assert 0 < (after - before).norm() < 0.5 * (start - before).norm()


def test_an_average_may_begin_or_end(toy, elsewhere, checkpoint, tmp_path: Path) -> None:
    assert len(prepared(elsewhere, checkpoint).averaged) == 0
    trained(toy, tmp_path).trainer.save_checkpoint(tmp_path / "raw.ckpt")
    made = prepared(elsewhere, tmp_path / "raw.ckpt", average=0.9)
    state = made.state_dict()
    names = [name for name in state if name.startswith("averaged.0.module.")]
    assert names
    assert all(torch.equal(state[n], state[n.replace("averaged.0.module.", "sampler.")]) for n in names)


def test_a_test_needs_no_pretrained_file(toy, checkpoint, tmp_path: Path) -> None:
    gone = starting(toy, tmp_path / "gone.ckpt", average=0.9)
    trainer(tmp_path, fast_dev_run=1).test(gone, toy, ckpt_path=checkpoint, verbose=False)


def test_another_skeleton_is_named_with_the_way_out(checkpoint) -> None:
    with pytest.raises(
        SagError, match=r"before\.ckpt was trained on the skeleton gta_im_19.*--data\.init_args\.skeleton prox_16"
    ):
        pretrained_state(checkpoint, {}, PROX_16)


def test_other_components_are_named(elsewhere, checkpoint) -> None:
    with pytest.raises(SagError, match=r"before\.ckpt does not fit: critics\.context.* there and missing here"):
        prepared(elsewhere, checkpoint, average=0.9, components=Components(context=False))


@pytest.mark.parametrize("damage", ["missing", "truncated", "no state", "other program"])
def test_a_wrong_file_is_named(elsewhere, checkpoint, damage: str) -> None:
    if damage == "missing":
        checkpoint.unlink()
    if damage == "truncated":
        checkpoint.write_bytes(checkpoint.read_bytes()[:-1000])
    if damage == "no state":
        torch.save({"weights": torch.zeros(3)}, checkpoint)
    if damage == "other program":
        torch.save({"state_dict": {"encoder.weight": torch.zeros(3)}}, checkpoint)
    with pytest.raises(SagError, match=r"^--pretrained .*before\.ckpt"):
        prepared(elsewhere, checkpoint, average=0.9)


def test_the_command_line_names_a_missing_file(toy_cache: Path, tmp_path: Path, capsys) -> None:
    tiny = tmp_path / "tiny.yaml"
    tiny.write_text(
        f"""
pretrained: {tmp_path}/none.ckpt
model: {{init_args: {{network: {{width: 0.05}}}}}}
data: {{class_path: toy_data.ToyDataModule, init_args: {{cache_dir: {toy_cache}, image_size: [36, 64], batch_size: 4}}}}
trainer: {{default_root_dir: {tmp_path}/run, accelerator: cpu, fast_dev_run: true}}
"""
    )
    assert main(["fit", "--config", str(CONFIGS / "base.yaml"), "--config", str(tiny)]) == 2
    assert f"pretrained {tmp_path}/none.ckpt is no file" in capsys.readouterr().err
    erd = ["--config", str(CONFIGS / "methods/erd.yaml"), "--trainer.fast_dev_run=true"]
    assert main(["fit", "--config", str(CONFIGS / "base.yaml"), "--config", str(tiny), *erd]) == 2
    assert "--pretrained is set, but ERDTraining is no method" in capsys.readouterr().err
