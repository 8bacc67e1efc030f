"""CSGN as a method of its own."""

from adversarial_contract import TINY, AdversarialContract, trainer
from torch import nn

from sag.components import Components, Network
from sag.methods import CSGN, SAG

NONE = Components(separate=False, depth=False, projection=False, context=False)


class TestCSGN(AdversarialContract):
    kind = CSGN

    def test_its_training_is_its_own(self) -> None:
        recipe = CSGN(TINY).recipe
        assert (recipe.learning_rate, recipe.betas) == (2e-4, (0.5, 0.999))
        assert (recipe.critic_steps, recipe.generator_steps, recipe.penalty_target) == (5, 1, 1.0)

    def test_no_preset_puts_norms_into_its_critic(self) -> None:
        modules = CSGN(Network(width=0.05, critic_norm="layer")).critics.modules()
        assert not any(isinstance(module, nn.BatchNorm1d | nn.GroupNorm) for module in modules)

    def test_its_networks_are_those_of_the_row_none(self) -> None:
        row = SAG(NONE, Network(width=0.05, critic_norm="none")).state_dict()
        assert {n: v.shape for n, v in CSGN(TINY).state_dict().items()} == {n: v.shape for n, v in row.items()}

    def test_the_generator_sees_every_batch_once(self, toy, tmp_path) -> None:
        method = self.made(toy)
        trainer(tmp_path, 2).fit(method, toy)  # 2 batches an epoch
        assert method.generator_steps == 4
