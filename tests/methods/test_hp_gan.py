"""HP-GAN."""

from dataclasses import replace

import pytest
import torch
from adversarial_contract import TINY, AdversarialContract, trainer

from sag.components import Network
from sag.methods import HPGAN
from sag.methods.hp_gan import HPGANRecipe, bone_loss, consistency
from sag.models.hp_gan import HPGANCriticNetwork, HPGANGenerator, HPGANSizes
from sag.models.scale import MotionScale


class TestHPGAN(AdversarialContract):
    kind = HPGAN

    def test_sizes_are_the_published_ones_at_full_width(self, skeleton) -> None:
        generator = HPGANGenerator(19, 256, HPGANSizes(), MotionScale(19, skeleton.root_index))
        critic = HPGANCriticNetwork(19, 256, HPGANSizes())
        assert HPGANSizes(*Network().channels(128, 128, 1024, 512)) == HPGANSizes()
        assert generator.embed.weight.shape == (128, 57 + 256)
        assert generator.encoder.weight_hh_l1.shape == generator.decoder.weight_hh_l1.shape == (3 * 1024, 1024)
        assert [mix.weight.shape for mix in generator.mix] == [(1024, 128)] * 2
        assert generator.out.weight.shape == (57, 1024)
        assert [tuple(m.weight.shape) for m in critic.judge if hasattr(m, "weight")] == [
            (512, 65 * 128 + 256),
            (512, 512),
            (512, 512),
            (1, 512),
        ]

    def test_it_starts_from_small_matrices(self) -> None:
        generator = HPGAN(TINY).sampler.generator
        for layer in (generator.embed, *generator.mix, generator.feed, generator.out):
            assert 7e-4 < layer.weight.std() < 1e-3
            assert layer.weight.abs().max() <= 2e-3

    def test_noise_is_uniform(self) -> None:
        (noise,) = HPGAN(TINY).sampler.generator.noise(400)
        assert noise.abs().max() <= 0.1
        assert noise.std() == pytest.approx(0.2 / 12**0.5, rel=0.05)

    def test_only_the_critics_matrices_decay(self) -> None:
        method = HPGAN(TINY)
        generator, critic = method.configure_optimizers()
        assert [group["weight_decay"] for group in critic.param_groups] == [1e-3, 0]
        assert all(p.dim() == 2 for p in critic.param_groups[0]["params"])
        assert sum(len(group["params"]) for group in critic.param_groups) == len(list(method.critics.parameters()))
        assert generator.param_groups[0]["weight_decay"] == 0

    def test_steps_on_each_batch(self, toy, tmp_path) -> None:
        method = self.made(toy, recipe=replace(HPGANRecipe(), critic_steps=3))
        trainer(tmp_path).fit(method, toy)  # 2 batches
        assert method.generator_steps == 4
        steps = [state["step"] for state in method.trainer.optimizers[1].state_dict()["state"].values()]
        assert set(map(int, steps)) == {6}

    def test_its_losses_are_paid(self, toy, tmp_path) -> None:
        method = self.made(toy)
        trainer(tmp_path).fit(method, toy)
        assert {f"train/generator/{name}" for name in ("consistency", "bones", "sequence")} <= set(
            method.trainer.callback_metrics
        )
        assert method.weights == {"consistency": 1e-3, "bones": 1e-2}


def test_consistency_is_one_norm_of_all_steps() -> None:
    vectors = torch.zeros(2, 65, 3)
    vectors[:, 40:] = 3.0  # one step of (3, 3, 3) in each of two motions
    assert consistency(vectors).item() == pytest.approx((2 * 27) ** 0.5 / (2 * 64))
    assert consistency(torch.ones(2, 65, 3)).item() == pytest.approx(1e-4)


def test_bones_are_held_against_frame_0(skeleton, batch) -> None:
    pose = batch.motion.pose[:, :1].repeat(1, 65, 1, 1)
    assert bone_loss(pose, skeleton).item() == pytest.approx(0, abs=1e-5)
    pose[:, 1:] *= 1.1
    assert bone_loss(pose, skeleton).item() == pytest.approx(0.1 * len(skeleton.bones), rel=1e-3)
    turned = pose[:, :1].repeat(1, 65, 1, 1)
    turned[:, 1:] = turned[:, 1:].flip(-1)
    assert bone_loss(turned, skeleton).item() == pytest.approx(0, abs=1e-5)
