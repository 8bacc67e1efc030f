from pathlib import Path
from typing import Any

import lightning.pytorch as pl
import pytest
import torch
from toy_data import ToyDataModule

from sag.components import Network
from sag.errors import SagError
from sag.methods import Cao
from sag.methods.cao import CaoRecipe
from sag.trainer import Trainer
from sag.types import Batch

SMALL = Network(width=0.05)


def trainer(folder: Path, epochs: int = 4, **options: Any) -> Trainer:
    quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False}
    never = {"check_val_every_n_epoch": 999, "num_sanity_val_steps": 0, "enable_checkpointing": False}
    return Trainer(max_epochs=epochs, default_root_dir=folder, accelerator="cpu", **quiet, **never, **options)


def method(**options: Any) -> Cao:
    torch.manual_seed(0)
    return Cao(**{"network": SMALL, **options})


def trained(toy: ToyDataModule, folder: Path, epochs: int = 4, **options: Any) -> Cao:
    made = method(**options)
    trainer(folder, epochs).fit(made, toy)
    return made


class Watch(pl.Callback):
    """Keeps every loss, and the weights of GoalNet after every epoch; stops after an epoch if told to."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.losses: dict[str, list[float]] = {}
        self.goal_nets: list[dict[str, torch.Tensor]] = []
        self.stop_after = stop_after

    def on_train_batch_end(self, trainer: pl.Trainer, *args: Any) -> None:
        for name, value in trainer.logged_metrics.items():
            self.losses.setdefault(name, []).append(float(value))

    def on_train_epoch_end(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        state = {**pl_module.goal_net.state_dict(), **pl_module.encoder.state_dict()}
        self.goal_nets.append({name: value.clone() for name, value in state.items()})
        trainer.should_stop = trainer.current_epoch + 1 == self.stop_after


def equal(one: dict[str, torch.Tensor], other: dict[str, torch.Tensor]) -> bool:
    return all(torch.equal(one[name], other[name]) for name in one)


def test_each_stage_overfits_a_single_batch(tmp_path: Path, toy_cache: Path) -> None:
    toy = ToyDataModule(toy_cache, windows=2)
    watch = Watch()
    made = method(recipe=CaoRecipe((3e-3, 5e-3, 1.5e-3), divergence=1e-4, stages=(30.0, 40.0, 150.0)))
    trainer(tmp_path, 220, callbacks=[watch]).fit(made, toy)
    for name in ("train/goal", "train/path", "train/pose"):
        losses = watch.losses[name]
        assert min(losses) < losses[0] / 10, name


def test_stages_follow_each_other_and_leave_each_other_alone(toy: ToyDataModule, tmp_path: Path) -> None:
    watch = Watch()
    made = method()
    trainer(tmp_path, 4, callbacks=[watch]).fit(made, toy)  # 2 batches an epoch
    assert made.stage_steps.tolist() == [4, 2, 2]
    assert int(made.generator_steps) == 8
    assert not equal(watch.goal_nets[0], watch.goal_nets[1])
    assert equal(watch.goal_nets[1], watch.goal_nets[3])


@pytest.mark.parametrize("epochs", [1, 3])
def test_every_stage_gets_a_batch(toy: ToyDataModule, tmp_path: Path, epochs: int) -> None:
    made = trained(toy, tmp_path, epochs, recipe=CaoRecipe(stages=(8.0, 1.0, 1.0)))
    assert made.trained
    assert (made.stage_steps > 0).all()


def test_a_fast_dev_run_trains_all_three(toy: ToyDataModule, tmp_path: Path) -> None:
    made = method()
    run = trainer(tmp_path, fast_dev_run=1)
    run.fit(made, toy)
    assert made.stage_steps.tolist() == [1, 1, 1]
    run.test(made, toy, verbose=False)
    assert run.predict(made, toy)[0]["joints"].shape == (4, 5, 65, 19, 3)


def test_an_interrupted_fit_goes_on_where_it_was(toy: ToyDataModule, tmp_path: Path) -> None:
    first = method()
    watch = Watch(stop_after=2)
    run = trainer(tmp_path, 4, callbacks=[watch])
    run.fit(first, toy)
    run.save_checkpoint(tmp_path / "x.ckpt")
    assert first.stage_steps.tolist() == [4, 0, 0]
    assert not first.trained
    again, later = method(), Watch()
    trainer(tmp_path, 4, callbacks=[later]).fit(again, toy, ckpt_path=tmp_path / "x.ckpt")
    assert again.stage_steps.tolist() == [4, 2, 2]
    assert equal(watch.goal_nets[-1], later.goal_nets[-1])


def test_a_checkpoint_brings_everything_back(toy: ToyDataModule, tmp_path: Path, batch: Batch) -> None:
    made = trained(toy, tmp_path)
    made.trainer.save_checkpoint(tmp_path / "x.ckpt")
    assert "state_dict" in torch.load(tmp_path / "x.ckpt", weights_only=True)
    fresh = method()
    trainer(tmp_path, fast_dev_run=1).test(fresh, toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)
    assert fresh.trained
    first, second = (m.eval().sample(batch, torch.Generator().manual_seed(1)).joints for m in (made, fresh))
    assert torch.equal(first, second)


def test_other_sizes_are_refused(toy: ToyDataModule, tmp_path: Path) -> None:
    trained(toy, tmp_path).trainer.save_checkpoint(tmp_path / "x.ckpt")
    other = method(network=Network(width=0.3))
    with pytest.raises(SagError, match="does not fit this Cao"):
        trainer(tmp_path, fast_dev_run=1).test(other, toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)


def test_what_is_half_trained_is_not_tested(toy: ToyDataModule, tmp_path: Path) -> None:
    made = method()
    trainer(tmp_path, 4, callbacks=[Watch(stop_after=2)]).fit(made, toy)
    with pytest.raises(SagError, match="never trained"):
        trainer(tmp_path).test(made, toy, verbose=False)


def test_shares_of_an_endless_run_are_refused(toy: ToyDataModule, tmp_path: Path) -> None:
    with pytest.raises(SagError, match=r"trainer\.max_epochs"):
        trainer(tmp_path, -1, max_steps=2).fit(method(), toy)


def test_a_stage_without_a_share_is_refused() -> None:
    with pytest.raises(SagError, match=r"recipe\.stages"):
        CaoRecipe(stages=(1.0, 0.0, 1.0))


@pytest.fixture
def made(toy: ToyDataModule, tmp_path: Path) -> Cao:
    return trained(toy, tmp_path).eval()


def test_a_motion_starts_at_the_given_frame(made: Cao, batch: Batch) -> None:
    motion = made.sample(batch)
    assert motion.joints.shape == (4, 65, 19, 3)
    assert torch.allclose(motion.joints[:, 0], batch.motion.joints[:, 0], atol=1e-6)
    assert not motion.pose[:, :, made.skeleton.root_index].any()


def test_one_seed_gives_one_motion(made: Cao, batch: Batch) -> None:
    torch.nn.init.normal_(made.goal_net.out.weight)
    made.goal_net.into.weight.data[:, : made.goal_net.latent] *= (
        50  # that so few steps have taught it nothing is no matter
    )
    one, same, other = (made.sample(batch, torch.Generator().manual_seed(seed)).joints for seed in (1, 1, 2))
    assert torch.equal(one, same)
    assert not torch.equal(one, other)


def test_all_chance_is_in_the_goal(made: Cao, batch: Batch) -> None:
    goals, motions = batch.motion.roots[:, -1], []
    for state in (1, 2):
        torch.manual_seed(state)
        motions.append(made.sample_to(batch, goals).joints)
    assert torch.equal(*motions)
    assert not torch.equal(motions[0], made.sample_to(batch, goals + 1).joints)


def test_only_the_place_of_a_goal_in_the_picture_counts(made: Cao, batch: Batch) -> None:
    goals = batch.motion.roots[:, -1]
    one, other = (made.sample_to(batch, scale * goals).joints for scale in (1.0, 1.5))
    assert torch.allclose(one, other, atol=1e-4)


def test_a_goal_out_of_sight_is_sought_at_the_edge(made: Cao, batch: Batch) -> None:
    goals = batch.motion.start + torch.tensor([1000.0, 0, 0])
    assert torch.equal(
        made.sample_to(batch, goals).joints, made.sample_to(batch, 2 * goals - batch.motion.start).joints
    )


def test_the_future_is_not_looked_at(made: Cao, batch: Batch) -> None:
    goals = batch.motion.roots[:, -1].clone()
    drawn, told = made.sample(batch, torch.Generator().manual_seed(0)), made.sample_to(batch, goals)
    batch.motion.trajectory[:, 1:] += 1
    batch.motion.pose[:, 1:] *= 2
    assert torch.equal(drawn.joints, made.sample(batch, torch.Generator().manual_seed(0)).joints)
    assert torch.equal(told.joints, made.sample_to(batch, goals).joints)


def test_the_scene_reaches_the_motion(made: Cao, batch: Batch) -> None:
    made.sample(batch).joints.square().sum().backward()
    assert made.encoder.fc.weight.grad.abs().sum() > 0


def test_a_blind_one_does_not_see_the_picture(batch: Batch) -> None:
    goals = batch.motion.roots[:, -1].clone()
    seeing, blind = (method(network=Network(width=0.05, blind=b)).eval() for b in (False, True))
    before = [m.sample_to(batch, goals).joints for m in (seeing, blind)]
    batch.scene.image = 1 - batch.scene.image
    after = [m.sample_to(batch, goals).joints for m in (seeing, blind)]
    assert not torch.equal(before[0], after[0])
    assert torch.equal(before[1], after[1])
