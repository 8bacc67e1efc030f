"""Two-Stage (Cai et al., ECCV 2018): first a generator of single poses, then one of latents that shift."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Literal, cast

import torch
from torch import Tensor

from sag.components import Network, build_encoder
from sag.methods.stages import check_shares, stages_due
from sag.methods.wgan import WGAN, Recipe
from sag.models.critics import Critic, SequenceCritic
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.models.two_stage import (
    RecurrentCriticNetwork,
    SinglePoseCritic,
    TwoStageGenerator,
    TwoStageSizes,
    residual_network,
)
from sag.processes import drawn
from sag.scoring import Evaluation
from sag.skeleton import skeleton_named
from sag.types import GENERATED, Batch, Condition, Motion

Stage = Literal["single", "frozen", "tuned"]
"""Single poses; sequences over a pose generator that stands still; sequences with all of it."""

STAGES: tuple[Stage, ...] = ("single", "frozen", "tuned")
"""In the order of training."""


@dataclass(frozen=True)
class TwoStageRecipe(Recipe):
    """How Two-Stage is trained.

    Attributes:
        stages: shares of the run's batches: single poses, sequences with the pose generator frozen, then tuned.
        shift: weight of the squared shifts.
    """

    stages: tuple[float, float, float] = (2.0, 1.0, 2.0)
    shift: float = 0.01

    def __post_init__(self) -> None:
        check_shares(self.stages)


class TwoStage(WGAN):
    """Two-Stage generation, given a scene and an initial pose; built from its description.

    Published: a WGAN-GP of single poses, both networks fully connected with residual blocks; then an LSTM that
    emits shifts of the latent, poses decoded from it by the first stage's generator, a bidirectional LSTM
    for a critic and an L2 on the shifts. There is no public code. Left out: its skeleton-to-picture half.
    Ours, since nothing else is known to us: widths, weight of the L2, shares of the stages, which one run trains
    one after the other, and the optimiser (Gulrajani et al.'s for a WGAN-GP). Ours for this task: scene feature
    and initial pose stand beside every latent and before both critics (the second has the pose as its first
    frame), and a pose is all of X in its frame, seen from the start, so that the root moves by latents too.
    Nothing ties the first latent to the initial pose but what it is told, so a jump is seen there.

    Args:
        network: sizes of the networks; the critic's norm is not looked at.
        skeleton: name of the skeleton; the command line takes it from the data.
        evaluation: the protocol of testing.
        recipe: how it is trained.
    """

    sequence_steps: Tensor

    def __init__(
        self,
        network: Network = Network(),  # noqa: B008 (frozen)
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
        recipe: TwoStageRecipe = TwoStageRecipe(),
    ) -> None:
        body = skeleton_named(skeleton)
        joints, feature = len(body.joints), network.generator_sizes.feature
        sizes = TwoStageSizes(*network.channels(*astuple(TwoStageSizes())))
        scale = MotionScale(joints, body.root_index, network.units)
        generator = TwoStageGenerator(joints, feature, sizes, scale)
        sampler = Sampler(build_encoder(network), generator, scale)
        judge = residual_network(6 * joints + feature, sizes.pose, 1)
        critics: dict[str, Critic] = {
            "pose": SinglePoseCritic(judge, scale),
            "sequence": SequenceCritic(RecurrentCriticNetwork(joints, feature, sizes), scale),
        }
        super().__init__(sampler, critics, recipe, skeleton, evaluation, {"shift": recipe.shift})
        self.stages = recipe.stages
        self.stage: Stage = "single"
        self.register_buffer("sequence_steps", torch.zeros((), dtype=torch.int64))

    @property
    def trained(self) -> bool:
        """Whether the generator has taken a step in the second stage."""
        return bool(self.sequence_steps > 0)

    @property
    def judges(self) -> dict[str, Critic]:
        """The critic of the stage."""
        name = "pose" if self.stage == "single" else "sequence"
        return {name: self.critics[name]}

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Trains what the stages of this batch train; the scene encoder learns in all of them."""
        pose = self._network.pose
        for stage in stages_due(self.trainer, self.stages):
            self.stage = STAGES[stage]
            pose.requires_grad_(self.stage != "frozen")
            super().training_step(batch, batch_idx)
            pose.requires_grad_(True)
            if self.stage != "single":
                self.sequence_steps = self.sequence_steps + self.recipe.generator_steps

    def generate(self, condition: Condition, given: Motion) -> tuple[Motion, dict[str, Tensor]]:
        """In the first stage poses that know nothing of each other, then motions with the price of their shifts."""
        count = len(given.start)
        if self.stage == "single":
            latents = drawn(lambda together: self._network.latents(together, GENERATED), count)
            return self._network.posed(condition, given, latents), {}
        motion, shifts = self._network.shifted(condition, given, drawn(self._network.noise, count))
        return motion, {"shift": shifts.square().sum(dim=-1).mean()}

    @property
    def _network(self) -> TwoStageGenerator:
        return cast(TwoStageGenerator, self.sampler.generator)
