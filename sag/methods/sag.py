"""SAG: the paper's system, and through its components every row of its Table 1."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
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
from sag.losses import critic_loss, generator_loss, gradient_penalty
from sag.methods.base import Method, Sample
from sag.models.critics import Critic
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.scoring import Evaluation
from sag.types import Batch, Condition, DepthMap, Motion


class SAG(Method):
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
    """

    generator_steps: Tensor

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
    ) -> None:
        super().__init__(skeleton, evaluation)
        self.automatic_optimization = False
        self.components = components or Components()
        scale = MotionScale(len(self.skeleton.joints), self.skeleton.root_index, network.units)
        generator = build_generator(self.components, network, self.skeleton, scale)
        self.sampler = Sampler(build_encoder(network), generator, scale)
        self.depth = build_depth(self.components, network, image_size)
        critics = build_critics(self.components, network, self.skeleton, scale)
        self.critics: Mapping[str, Critic] = nn.ModuleDict(critics)  # type: ignore[assignment]
        self.averaged = _averaged(self.sampler, average)
        self.register_buffer("generator_steps", torch.zeros((), dtype=torch.int64))
        self.network = network
        self.learning_rate, self.betas = learning_rate, betas
        self.critic_steps, self.penalty, self.penalty_target = critic_steps, penalty, penalty_target
        self.weights = self._checked(weights)

    def _checked(self, weights: dict[str, float]) -> dict[str, float]:
        for name in weights:
            if name not in LOSSES:
                raise SagError(f"model.init_args.weights names {name!r}; losses are {', '.join(LOSSES)}")
        return {name: weights.get(name, 1.0) for name in LOSSES}

    @property
    def trained(self) -> bool:
        """Whether the generator has taken a step."""
        return bool(self.generator_steps > 0)

    def prepare(self, motion: Motion) -> None:
        """Takes normalisation from the training split's motion, and says what the scene encoder starts from."""
        self.print(f"the scene encoder starts from {self.network.imagenet or 'random weights, not from ImageNet'}")
        self.sampler.scale.fit(motion)
        for averaged in self._averages():
            averaged.module.scale.load_state_dict(self.sampler.scale.state_dict())

    def configure_optimizers(self) -> tuple[torch.optim.Optimizer, torch.optim.Optimizer]:
        """One Adam for encoder, depth decoder and generators, one for all critics."""

        def adam(*modules: Any) -> torch.optim.Optimizer:
            parameters = itertools.chain.from_iterable(m.parameters() for m in modules)
            return torch.optim.Adam(parameters, self.learning_rate, self.betas)

        return adam(self.sampler, self.depth), adam(self.critics)

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Every batch trains the critics, and every `critic_steps`-th one of the whole fit the generator too."""
        place = self.trainer.fit_loop.epoch_loop.total_batch_idx  # type: ignore[attr-defined]
        generator_due = (place + 1) % self.critic_steps == 0
        with torch.set_grad_enabled(generator_due):
            condition = self.sampler.condition(batch.scene, batch.motion)
            depth, losses = self.depth(condition.feature, batch.scene)
            noise = self.sampler.generator.noise(len(batch))
            fake = self.sampler.generator(condition, batch.motion, noise)
        seen = condition.detach()
        self._train_critics(batch.motion, fake.detach(), seen, depth)
        if generator_due:
            self._train_generator(fake, seen, depth, losses)

    def _train_critics(self, real: Motion, fake: Motion, condition: Condition, depth: DepthMap) -> None:
        total = torch.zeros((), device=self.device)
        logged: dict[str, Tensor] = {}
        for name, critic in self.critics.items():
            real_view, fake_view = critic.view(real, depth), critic.view(fake, depth)
            loss = critic_loss(critic(real_view, condition), critic(fake_view, condition))

            def score(view: Tensor, critic: Critic = critic) -> Tensor:
                return critic(view, condition)

            penalty = gradient_penalty(score, real_view, fake_view, self.penalty_target)
            total = total + loss + self.penalty * penalty
            logged |= {f"train/critic/{name}": loss.detach(), f"train/penalty/{name}": penalty.detach()}
        self._step(1, total)
        self.log_dict(logged)

    def _train_generator(self, fake: Motion, condition: Condition, depth: DepthMap, losses: dict[str, Tensor]) -> None:
        for parameter in self.critics.parameters():  # type: ignore[attr-defined]
            parameter.requires_grad_(False)
        for name, critic in self.critics.items():
            losses[name] = generator_loss(critic(critic.view(fake, depth), condition))
        self._step(0, sum(self.weights[name] * loss for name, loss in losses.items()))
        for parameter in self.critics.parameters():  # type: ignore[attr-defined]
            parameter.requires_grad_(True)
        for averaged in self._averages():
            averaged.update_parameters(self.sampler)
        self.generator_steps = self.generator_steps + 1
        self.log_dict({f"train/generator/{name}": loss.detach() for name, loss in losses.items()})
        self.log("train/generator_step", self.generator_steps.float())

    def _step(self, which: int, loss: Any) -> None:
        optimizer: Any = self.optimizers()[which]  # type: ignore[index]
        optimizer.zero_grad(set_to_none=True)
        self.manual_backward(loss)
        optimizer.step()

    def _averages(self) -> list[Any]:
        """The averaged sampler, if there is one."""
        return list(self.averaged)

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window, from the averaged generator where there is one."""
        averages = self._averages()
        sampler = averages[0].module if averages else self.sampler
        return sampler(batch.scene, batch.motion, generator)

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
