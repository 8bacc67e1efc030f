"""What every method that trains against critics must do, whatever its networks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

import lightning.pytorch as pl
import pytest
import torch
from toy_data import ToyDataModule

from sag.components import Network
from sag.errors import SagError
from sag.losses import critic_loss
from sag.methods.wgan import WGAN
from sag.trainer import Trainer
from sag.types import Batch, DepthMap

TINY = Network(width=0.05)


def trainer(folder: Path, epochs: int = 1, **options) -> Trainer:
    quiet = {"enable_progress_bar": False, "enable_model_summary": False, "logger": False}
    never = {"check_val_every_n_epoch": 99, "num_sanity_val_steps": 0, "enable_checkpointing": False}
    return Trainer(max_epochs=epochs, default_root_dir=folder, accelerator="cpu", **quiet, **never, **options)


class Start(pl.Callback):
    """Keeps the weights that a training starts from."""

    def on_train_start(self, trainer: pl.Trainer, pl_module: pl.LightningModule) -> None:
        self.state = {name: value.clone() for name, value in pl_module.state_dict().items()}


def depth_of(batch: Batch) -> DepthMap:
    return DepthMap(batch.scene.depth, batch.scene.intrinsics)


class AdversarialContract:
    """Tests of one method; a class that says which inherits them.

    Attributes:
        kind: the method.
        rate: learning rate at which its generator fits a batch.
        steps: after which it must.
        options: with which it is stopped and goes on.
    """

    kind: Callable[..., WGAN]
    rate = 1e-2
    steps = 60
    options: ClassVar[dict[str, object]] = {}

    def made(self, toy: ToyDataModule, **options) -> WGAN:
        torch.manual_seed(0)
        method = self.kind(TINY, **options)
        method.prepare(toy.training_motion)
        return method

    def test_a_dry_run_takes_steps(self, toy: ToyDataModule, tmp_path: Path) -> None:
        method = self.made(toy)
        dry = trainer(tmp_path, fast_dev_run=True)
        dry.fit(method, toy)
        dry.test(method, toy, verbose=False)
        assert method.generator_steps > 0
        assert not list(tmp_path.iterdir())

    def test_samples_repeat_and_differ(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy).eval()
        first, again, other = (method.sample(batch, torch.Generator().manual_seed(seed)).joints for seed in (1, 1, 2))
        assert first.shape == (4, 65, 19, 3)
        assert torch.equal(first, again)
        assert not torch.equal(first[:, 1:], other[:, 1:])
        torch.testing.assert_close(first[:, 0], batch.motion.joints[:, 0])

    def test_later_frames_are_not_looked_at(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy).eval()
        seen = method.sample(batch, torch.Generator().manual_seed(1)).joints
        batch.motion.trajectory[:, 1:] += 1
        batch.motion.pose[:, 1:] *= 2
        assert torch.equal(seen, method.sample(batch, torch.Generator().manual_seed(1)).joints)

    def test_scene_and_initial_pose_reach_the_motion(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy)
        condition = method.sampler.condition(batch.scene, batch.motion)
        condition.initial_pose.requires_grad_()
        generator = method.sampler.generator
        joints = generator(condition, batch.motion, generator.noise(4)).joints
        joints[:, 1:].square().sum().backward()
        assert method.sampler.encoder.fc.weight.grad.abs().max() > 0
        assert (condition.initial_pose.grad.abs().amax(dim=1) > 0).all()

    def test_critics_see_scene_and_every_window(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy)
        condition = method.sampler.condition(batch.scene, batch.motion).detach()
        condition.feature.requires_grad_()
        for critic in method.critics.values():
            view = critic.view(batch.motion, depth_of(batch)).requires_grad_()
            found = torch.autograd.grad(critic(view, condition).sum(), (view, condition.feature))
            assert all((gradient.flatten(1).abs().amax(dim=1) > 0).all() for gradient in found)

    def test_its_generator_fits_a_batch(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy)
        sampler = method.sampler
        optimizer = torch.optim.Adam(sampler.parameters(), self.rate)
        true, errors = sampler.scale.vectors(batch.motion), []
        for _ in range(self.steps):
            motion = sampler(batch.scene, batch.motion)
            loss = (sampler.scale.vectors(motion) - true)[:, 1:].square().mean()
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            errors.append(float(loss.detach()))
        assert min(errors[-5:]) < errors[0] / 10

    def test_its_critics_tell_a_batch_from_samples(self, toy: ToyDataModule, batch: Batch) -> None:
        method = self.made(toy)
        _, optimizer = method.configure_optimizers()
        optimizer.param_groups[0]["lr"] = 1e-2
        condition = method.sampler.condition(batch.scene, batch.motion).detach()
        fake = method.sampler(batch.scene, batch.motion).detach()
        depth, losses = depth_of(batch), []
        for _ in range(20):
            scores = [[c(c.view(m, depth), condition) for m in (batch.motion, fake)] for c in method.critics.values()]
            each = torch.stack([critic_loss(*pair) for pair in scores])
            optimizer.zero_grad()
            each.sum().backward()
            optimizer.step()
            losses.append(each.detach())
        assert (losses[-1] < -10 * losses[0].abs()).all()

    def test_it_goes_on_where_it_stopped(self, toy: ToyDataModule, tmp_path: Path) -> None:
        path = tmp_path / "x.ckpt"
        first = self.made(toy, **self.options)
        run = trainer(tmp_path, 2)
        run.fit(first, toy)
        run.save_checkpoint(path)
        assert "state_dict" in torch.load(path, weights_only=True)
        second, start = self.made(toy, **self.options), Start()
        trainer(tmp_path, 4, callbacks=[start]).fit(second, toy, ckpt_path=path)
        assert all(torch.equal(value, start.state[name]) for name, value in first.state_dict().items())
        assert second.generator_steps == 2 * first.generator_steps
        adam = second.trainer.optimizers[1].state_dict()["state"]
        assert max(int(state["step"]) for state in adam.values()) == second.recipe.critic_steps * self.batches_of(8)

    def batches_of(self, batches: int) -> int:
        """Of so many batches in four epochs, those that one and the same critic learns from."""
        return batches

    def test_a_checkpoint_of_other_sizes_is_refused(self, toy: ToyDataModule, tmp_path: Path) -> None:
        method = self.made(toy)
        run = trainer(tmp_path, 1)
        run.fit(method, toy)
        run.save_checkpoint(tmp_path / "x.ckpt")
        other = self.kind(Network(width=0.1))
        with pytest.raises(SagError, match=f"does not fit this {type(method).__name__}"):
            trainer(tmp_path, fast_dev_run=1).test(other, toy, ckpt_path=tmp_path / "x.ckpt", verbose=False)
