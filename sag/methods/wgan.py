"""Training by WGAN-GP, shared by every method that has a generator and critics (Gulrajani et al., NeurIPS 2017)."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import torch
from torch import Generator, Tensor, nn

from sag.losses import critic_loss, generator_loss, gradient_penalty
from sag.methods.base import Method
from sag.methods.encoder_start import start_encoder
from sag.methods.terms import record
from sag.models.critics import Critic
from sag.models.sampler import Sampler
from sag.processes import drawn
from sag.scoring import Evaluation
from sag.types import Batch, Condition, DepthMap, Motion, Scene


@dataclass(frozen=True)
class Recipe:
    """How a method's authors train it, which no preset changes; the defaults are those of Gulrajani et al.

    Attributes:
        learning_rate: of both Adams.
        betas: of both Adams.
        critic_steps: steps of the critics on each batch.
        generator_steps: steps of the generator after them, on the same batch.
        penalty: weight of the gradient penalty.
        penalty_target: norm that the penalty asks of a critic's gradient.
    """

    learning_rate: float = 1e-4
    betas: tuple[float, float] = (0.0, 0.9)
    critic_steps: int = 5
    generator_steps: int = 1
    penalty: float = 10.0
    penalty_target: float = 1.0


class WGAN(Method):
    """A generator and its critics, trained against each other by manual optimisation.

    Attributes:
        penalty_axes: leading axes of a view whose gradient has a norm of its own, see `gradient_penalty`.

    Args:
        sampler: what is left when training is over: scene encoder and generator.
        critics: by name.
        recipe: optimisers and steps.
        skeleton: name of the skeleton.
        evaluation: the protocol of testing.
        weights: factor on each loss of the generator by its name; 1 where none is given.
    """

    generator_steps: Tensor
    penalty_axes = 1

    def __init__(
        self,
        sampler: Sampler,
        critics: dict[str, Critic],
        recipe: Recipe,
        skeleton: str,
        evaluation: Evaluation,
        weights: Mapping[str, float] = {},
    ) -> None:
        super().__init__(skeleton, evaluation)
        self.automatic_optimization = False
        self.sampler = sampler
        self.critics: Mapping[str, Critic] = nn.ModuleDict(critics)  # type: ignore[assignment]
        self.register_buffer("generator_steps", torch.zeros((), dtype=torch.int64))
        self.recipe = recipe
        self.weights = weights

    @property
    def trained(self) -> bool:
        """Whether the generator has taken a step."""
        return bool(self.generator_steps > 0)

    @property
    def drawing(self) -> Sampler:
        """The sampler that motions are drawn from, once trained."""
        return self.sampler

    def scene_feature(self, batch: Batch) -> Tensor:
        """f of the sampler that motions are drawn from."""
        return self.drawing.encoder(batch.scene.image)

    @property
    def judges(self) -> dict[str, Critic]:
        """The critics that train now; all of them unless a method trains in stages."""
        return dict(self.critics.items())

    def begin(self) -> None:
        """Loads what the scene encoder starts from, and says what that is."""
        self.print(f"the scene encoder starts from {start_encoder(self.sampler.encoder)}")

    def prepare(self, motion: Motion) -> None:
        """Takes normalisation from the training split's motion."""
        self.sampler.scale.fit(motion)

    def configure_optimizers(self) -> tuple[torch.optim.Optimizer, torch.optim.Optimizer]:
        """One Adam for scene encoder and generator, one for all critics."""
        return self._adam(self.sampler), self._adam(self.critics)

    def _adam(self, *modules: Any) -> torch.optim.Optimizer:
        parameters = itertools.chain.from_iterable(m.parameters() for m in modules)
        return torch.optim.Adam(parameters, self.recipe.learning_rate, self.recipe.betas)

    def seen(self, condition: Condition, scene: Scene) -> DepthMap:
        """The depth in which critics see motions: the data's own."""
        return DepthMap(scene.depth, scene.intrinsics)

    def generate(self, condition: Condition, given: Motion) -> tuple[Motion, dict[str, Tensor]]:
        """Motions to train on, and what the generator pays for them besides its critics' scores, by name."""
        generator = self.sampler.generator
        return generator(condition, given, drawn(generator.noise, len(given.start))), {}

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """The critics' steps on a batch and one set of motions, then the generator's steps on the same batch."""
        with torch.no_grad():
            condition = self.sampler.condition(batch.scene, batch.motion)
            scene = self.seen(condition, batch.scene)
            fake, _ = self.generate(condition, batch.motion)
        for _ in range(self.recipe.critic_steps):
            self._train_critics(batch.motion, fake, condition, scene)
        for _ in range(self.recipe.generator_steps):
            condition = self.sampler.condition(batch.scene, batch.motion)
            fake, losses = self.generate(condition, batch.motion)
            self._train_generator(fake, condition.detach(), scene, losses)

    def _train_critics(self, real: Motion, fake: Motion, condition: Condition, scene: DepthMap) -> None:
        total = torch.zeros((), device=self.device)
        logged: dict[str, Tensor] = {}
        for name, critic in self.judges.items():
            real_view, fake_view = critic.view(real, scene), critic.view(fake, scene)
            loss = critic_loss(critic(real_view, condition), critic(fake_view, condition))

            def score(view: Tensor, critic: Critic = critic) -> Tensor:
                return critic(view, condition)

            penalty = gradient_penalty(score, real_view, fake_view, self.recipe.penalty_target, self.penalty_axes)
            total = total + loss + self.recipe.penalty * penalty
            logged |= {f"train/critic/{name}": loss, f"train/penalty/{name}": penalty}
        record(self, logged)
        self._step(1, total)

    def _train_generator(self, fake: Motion, condition: Condition, scene: DepthMap, losses: dict[str, Tensor]) -> None:
        critics: Any = self.critics
        critics.requires_grad_(False)
        for name, critic in self.judges.items():
            losses[name] = generator_loss(critic(critic.view(fake, scene), condition))
        record(self, {f"train/generator/{name}": loss for name, loss in losses.items()})
        self._step(0, sum(self.weights.get(name, 1.0) * loss for name, loss in losses.items()))
        critics.requires_grad_(True)
        self.generator_steps = self.generator_steps + 1
        self.log("train/generator_step", self.generator_steps.float())

    def draw(self, count: int, generator: Generator) -> None:
        """Draws the generator's noise, and leaves it."""
        self.drawing.generator.noise(count, generator)

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window."""
        return self.drawing(batch.scene, batch.motion, generator)

    def samples(self, batch: Batch, count: int, generator: Generator | None = None) -> list[Motion]:
        """So many motions for each window, whose picture is looked at once."""
        return self.drawing.several(batch.scene, batch.motion, count, generator)
