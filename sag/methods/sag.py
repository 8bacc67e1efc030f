"""SAG: the paper's system, and through its components every row of its Table 1."""

from __future__ import annotations

from typing import Any

import torch
from torch import Generator, Tensor, nn
from torch.optim.swa_utils import AveragedModel

from sag.components import (
    LOSSES,
    Components,
    Network,
    build_critics,
    build_depth,
    build_encoder,
    build_generator,
)
from sag.errors import SagError
from sag.methods.base import Sample
from sag.methods.rates import checked_share, set_rates
from sag.methods.wgan import WGAN, Recipe
from sag.models.precision import full_precision
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.scoring import Evaluation
from sag.skeleton import skeleton_named
from sag.types import Batch, Condition, DepthMap, Motion, Scene


class SAG(WGAN):
    """Scene-aware generative network, a WGAN-GP trained by manual optimisation (paper, 3 and 4.2).

    Args:
        components: which of M, D, P and C are on; all of them when left out.
        network: sizes and choices of the networks.
        skeleton: name of the skeleton; the command line takes it from the data.
        image_size: rows and columns of the picture; the command line takes it from the data.
        evaluation: the protocol of testing.
        learning_rate: of both Adams.
        betas: of both Adams.
        critic_steps: batches that the critics see for each one that the generator sees.
        penalty: weight of the gradient penalty.
        penalty_target: norm that the penalty asks of a critic's gradient.
        average: decay of the averaged generator that samples; 0 samples from the raw one.
        weights: factor on each loss of the generator by its name; 1 where none is given.
        falling_from: share of the training after which the learning rate falls, in a line to 0 at its end; 1 keeps it.
    """

    def __init__(
        self,
        components: Components | None = None,
        network: Network = Network(),  # noqa: B008 (frozen)
        skeleton: str = "gta_im_19",
        image_size: tuple[int, int] = (288, 512),
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
        learning_rate: float = 2e-4,
        betas: tuple[float, float] = (0.5, 0.999),
        critic_steps: int = 1,
        penalty: float = 10.0,
        penalty_target: float = 0.1,
        average: float = 0.0,
        weights: dict[str, float] = {},
        falling_from: float = 1.0,
    ) -> None:
        components = components or Components()
        body = skeleton_named(skeleton)
        scale = MotionScale(len(body.joints), body.root_index, network.units)
        generator = build_generator(components, network, body, scale)
        sampler = Sampler(build_encoder(network), generator, scale)
        depth = build_depth(components, network, image_size)
        critics = build_critics(components, network, body, scale)
        recipe = Recipe(learning_rate, betas, penalty=penalty, penalty_target=penalty_target)
        super().__init__(sampler, critics, recipe, skeleton, evaluation, self._checked(weights))
        self.components, self.network = components, network
        self.depth = depth
        self.averaged = _averaged(self.sampler, average)
        self.critic_steps = critic_steps
        self.falling_from = checked_share(falling_from)

    @staticmethod
    def _checked(weights: dict[str, float]) -> dict[str, float]:
        for name in weights:
            if name not in LOSSES:
                raise SagError(f"model.init_args.weights names {name!r}; losses are {', '.join(LOSSES)}")
        return {name: weights.get(name, 1.0) for name in LOSSES}

    def prepare(self, motion: Motion) -> None:
        """As every WGAN; the averaged sampler has the same normalisation."""
        super().prepare(motion)
        for averaged in self._averages():
            averaged.module.scale.load_state_dict(self.sampler.scale.state_dict())

    def configure_optimizers(self) -> tuple[torch.optim.Optimizer, torch.optim.Optimizer]:
        """One Adam for encoder, depth decoder and generators, one for all critics."""
        return self._adam(self.sampler, self.depth), self._adam(self.critics)

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Every batch trains the critics, and every `critic_steps`-th one of the whole fit the generator too."""
        place = self.trainer.fit_loop.epoch_loop.total_batch_idx  # type: ignore[attr-defined]
        set_rates(self, place, self.recipe.learning_rate, self.falling_from)
        generator_due = (place + 1) % self.critic_steps == 0
        with torch.set_grad_enabled(generator_due):
            condition = self.sampler.condition(batch.scene, batch.motion)
        with full_precision(condition.feature):
            with torch.set_grad_enabled(generator_due):
                depth, losses = self.depth(condition.feature, batch.scene)
                fake, _ = self.generate(condition, batch.motion)
            seen = condition.detach()
            self._train_critics(batch.motion, fake.detach(), seen, depth)
            if generator_due:
                self._train_generator(fake, seen, depth, losses)

    def _train_generator(self, fake: Motion, condition: Condition, scene: DepthMap, losses: dict[str, Tensor]) -> None:
        super()._train_generator(fake, condition, scene, losses)
        for averaged in self._averages():
            averaged.update_parameters(self.sampler)

    def seen(self, condition: Condition, scene: Scene) -> DepthMap:
        """The data's own, or the decoder's, as `network.context_depth` has it."""
        return self.depth(condition.feature, scene)[0]

    def _averages(self) -> list[Any]:
        """The averaged sampler, if there is one."""
        return list(self.averaged)

    @property
    def drawing(self) -> Sampler:
        """The averaged sampler where there is one."""
        averages = self._averages()
        return averages[0].module if averages else self.sampler

    def predicted_depth(self, batch: Batch) -> Tensor | None:
        """Depth decoded from f, where D is on."""
        return self.depth.decoded(self.sampler.encoder(batch.scene.image))

    def variants(self) -> dict[str, Sample]:
        """The raw generator, where the one that samples is an average."""
        return {"raw": self.sample_raw} if len(self.averaged) else {}

    def sample_raw(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window from the generator as it is, without averaging."""
        return self.sampler(batch.scene, batch.motion, generator)


def _averaged(sampler: Sampler, decay: float) -> nn.ModuleList:
    """An exponential moving average of weights and batch-norm buffers, or nothing when decay is 0."""
    if not 0 <= decay < 1:
        raise SagError(f"model.init_args.average is {decay}; it must be at least 0 and below 1")

    def mix(average: Tensor, current: Tensor, count: Tensor | int) -> Tensor:
        # A short memory at first, so that the start's random weights are soon forgotten.
        share = 1 - min(decay, (1 + int(count)) / (10 + int(count)))
        return torch.lerp(average.float(), current.float(), share)

    averaged = [AveragedModel(sampler, avg_fn=mix, use_buffers=True)] if decay else []
    return nn.ModuleList(averaged).requires_grad_(False)
