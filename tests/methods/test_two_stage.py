"""Two-Stage."""

from typing import ClassVar

import lightning.pytorch as pl
import pytest
import torch
from adversarial_contract import AdversarialContract, depth_of, trainer

from sag.errors import SagError
from sag.losses import gradient_penalty
from sag.methods import TwoStage
from sag.methods.two_stage import TwoStageRecipe

THIRDS = TwoStageRecipe(critic_steps=1, stages=(1, 1, 1))


class Changes(pl.Callback):
    """Notes, for each batch, its stage and which parts it changed."""

    def __init__(self) -> None:
        self.found: list[tuple[str, set[str]]] = []

    def parts(self, method: TwoStage) -> dict[str, torch.Tensor]:
        generator = method.sampler.generator
        modules = {"encoder": method.sampler.encoder, "poses": generator.pose, "shifts": generator.shifts}
        modules |= {f"critic of {name}": critic for name, critic in method.critics.items()}
        return {n: torch.cat([p.detach().flatten() for p in m.parameters()]).clone() for n, m in modules.items()}

    def on_train_batch_start(self, trainer, pl_module, *args) -> None:
        self.before = self.parts(pl_module)

    def on_train_batch_end(self, trainer, pl_module, *args) -> None:
        after = self.parts(pl_module)
        self.found.append((pl_module.stage, {n for n in after if not torch.equal(after[n], self.before[n])}))


class TestTwoStage(AdversarialContract):
    kind = TwoStage

    options: ClassVar = {"recipe": TwoStageRecipe(stages=(1, 1, 2))}

    def batches_of(self, batches: int) -> int:
        return batches - 1  # the first of all trains the other critic

    def test_three_parts_of_one_training(self, toy, tmp_path) -> None:
        method, changes = self.made(toy, recipe=THIRDS), Changes()
        trainer(tmp_path, 3, callbacks=[changes]).fit(method, toy)  # 2 batches an epoch
        sequence = {"encoder", "shifts", "critic of sequence"}
        assert changes.found == [
            *[("single", {"encoder", "poses", "critic of pose"})] * 2,
            *[("frozen", sequence)] * 2,
            *[("tuned", sequence | {"poses"})] * 2,
        ]
        assert (method.generator_steps, method.sequence_steps) == (6, 4)
        assert all(p.requires_grad for p in method.parameters())

    def test_a_short_run_has_all_stages(self, toy, tmp_path) -> None:
        method = self.made(toy)
        trainer(tmp_path, limit_train_batches=1).fit(method, toy)
        assert (method.generator_steps, method.sequence_steps) == (3, 2)
        assert method.trained

    def test_the_first_stage_alone_is_no_method(self, toy, tmp_path) -> None:
        method = self.made(toy)

        class Stopped(pl.Callback):
            def on_train_batch_end(self, trainer, *args) -> None:
                trainer.should_stop = True

        trainer(tmp_path, 10, callbacks=[Stopped()]).fit(method, toy)
        assert method.generator_steps == 1
        assert not method.trained

    def test_a_stage_without_a_share_is_refused(self) -> None:
        with pytest.raises(SagError, match=r"recipe\.stages .* above 0"):
            TwoStageRecipe(stages=(1, 0, 1))

    def test_an_endless_training_is_refused(self, toy, tmp_path) -> None:
        with pytest.raises(SagError, match="max_epochs"):
            trainer(tmp_path, -1).fit(self.made(toy), toy)

    def test_a_latent_moves_its_own_frame_alone(self, toy, batch) -> None:
        method = self.made(toy)
        generator = method.sampler.generator
        condition = method.sampler.condition(batch.scene, batch.motion)
        latents = generator.latents(4, 64)
        before = generator.posed(condition, batch.motion, latents).joints
        latents[:, 9] = 0
        changed = (generator.posed(condition, batch.motion, latents).joints != before).flatten(2).any(dim=2)
        assert changed[:, 10].all()
        assert changed.sum() == 4

    def test_latents_walk_by_small_shifts(self, toy, batch) -> None:
        method = self.made(toy)
        generator = method.sampler.generator
        condition = method.sampler.condition(batch.scene, batch.motion)
        noise = generator.noise(4)
        motion, shifts = generator.shifted(condition, batch.motion, noise)
        assert shifts.abs().max() <= 1
        latents = noise[0][:, None] + shifts.cumsum(dim=1)
        torch.testing.assert_close(motion.joints, generator.posed(condition, batch.motion, latents).joints)

    def test_the_first_critic_sees_single_poses(self, toy, batch) -> None:
        method = self.made(toy)
        critic = method.critics["pose"]
        condition = method.sampler.condition(batch.scene, batch.motion).detach()
        view = critic.view(batch.motion, depth_of(batch)).requires_grad_()
        assert view.shape == (4 * 64, 57)
        score = critic(view, condition)
        (gradient,) = torch.autograd.grad(score[70], view)
        assert gradient[70].abs().max() > 0
        assert gradient.abs().sum() == gradient[70].abs().sum()

    def test_the_second_critics_penalty_trains_it_without_cudnn(self, toy, batch, monkeypatch) -> None:
        method = self.made(toy)
        critic = method.critics["sequence"]
        condition = method.sampler.condition(batch.scene, batch.motion).detach()
        cudnn = []
        critic.network.memory.register_forward_hook(lambda *_: cudnn.append(torch.backends.cudnn.enabled))
        real = critic.view(batch.motion, depth_of(batch))
        gradient_penalty(lambda view: critic(view, condition), real, torch.randn_like(real), 1.0).backward()
        assert critic.network.memory.weight_hh_l0_reverse.grad.abs().max() > 0
        assert cudnn == [False]
