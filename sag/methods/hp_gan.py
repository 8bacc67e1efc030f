"""HP-GAN (Barsoum et al., CVPR workshops 2018): recurrent, from the frames that are given to those that follow."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from sag.components import Network, build_encoder
from sag.methods.wgan import WGAN, Recipe
from sag.models.critics import SequenceCritic
from sag.models.hp_gan import HPGANCriticNetwork, HPGANGenerator, HPGANSizes
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.processes import processes, summed
from sag.scoring import Evaluation
from sag.skeleton import Skeleton, skeleton_named
from sag.types import Condition, Motion


@dataclass(frozen=True)
class HPGANRecipe(Recipe):
    """How HP-GAN's authors train it.

    Attributes:
        critic_decay: weight of the halved squared norm of the critic's matrices.
        consistency: weight of the loss of that name.
        bones: weight of the loss of that name.
    """

    learning_rate: float = 5e-5
    betas: tuple[float, float] = (0.9, 0.999)
    critic_steps: int = 9
    generator_steps: int = 2
    critic_decay: float = 1e-3
    consistency: float = 1e-3
    bones: float = 1e-2


class HPGAN(WGAN):
    """HP-GAN, given a scene and one pose; after its public code.

    Published: both networks, their start, the losses with their weights, Adam at 5e-5, batches of 16 and nine
    critic and two generator steps on each. Its known fault, a jump at the first generated frame, is left in.
    Changed: one frame is given in place of ten, and 64 are generated in place of 20; frame 0 comes with the
    scene feature into the embedding; each step has noise of its own, each window its own mixture in the
    penalty. Left out: the critic's twin that only scores quality, which is measured here for all methods
    alike. Ours: the critic sees the scene feature, and z-scores are taken joint by joint.

    Args:
        network: sizes of the networks; the critic's norm is not looked at.
        skeleton: name of the skeleton; the command line takes it from the data.
        evaluation: the protocol of testing.
        recipe: how it is trained.
    """

    penalty_axes = 2

    def __init__(
        self,
        network: Network = Network(),  # noqa: B008 (frozen)
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
        recipe: HPGANRecipe = HPGANRecipe(),
    ) -> None:
        body = skeleton_named(skeleton)
        joints, feature = len(body.joints), network.generator_sizes.feature
        sizes = HPGANSizes(*network.channels(*astuple(HPGANSizes())))
        scale = MotionScale(joints, body.root_index, network.units)
        sampler = Sampler(build_encoder(network), HPGANGenerator(joints, feature, sizes, scale), scale)
        critic = SequenceCritic(HPGANCriticNetwork(joints, feature, sizes), scale)
        weights = {"consistency": recipe.consistency, "bones": recipe.bones}
        super().__init__(sampler, {"sequence": critic}, recipe, skeleton, evaluation, weights)
        self.critic_decay = recipe.critic_decay

    def configure_optimizers(self) -> tuple[torch.optim.Optimizer, torch.optim.Optimizer]:
        """Two Adams; the critic's matrices are drawn to zero, its biases are not."""
        generator, critic = super().configure_optimizers()
        (group,) = critic.param_groups
        matrices = [p for p in group["params"] if p.dim() > 1]
        biases = [p for p in group["params"] if p.dim() == 1]
        groups: list[dict[str, Any]] = [{"params": matrices, "weight_decay": self.critic_decay}, {"params": biases}]
        return generator, torch.optim.Adam(groups, self.recipe.learning_rate, self.recipe.betas)

    def generate(self, condition: Condition, given: Motion) -> tuple[Motion, dict[str, Tensor]]:
        """Motions, and the two losses that ask for smooth frames and for bones that keep their lengths."""
        motion, _ = super().generate(condition, given)
        vectors = self.sampler.scale.vectors(motion)
        return motion, {"consistency": consistency(vectors), "bones": bone_loss(motion.pose, self.skeleton)}


def consistency(vectors: Float[Tensor, "b t c"]) -> Float[Tensor, ""]:
    """Norm of all differences between neighbouring frames of a batch at once, over their number; 1e-4 at least."""
    steps = vectors.diff(dim=1)
    together = summed(steps.norm().square()).sqrt() if processes() > 1 else steps.norm()
    return (together / (processes() * steps.shape[0] * steps.shape[1])).clamp_min(1e-4)


def bone_loss(pose: Float[Tensor, "b t j 3"], skeleton: Skeleton) -> Float[Tensor, ""]:
    """Relative error of the bones' lengths against frame 0's, summed over bones and averaged over generated frames."""
    parent, child = torch.as_tensor(skeleton.bone_index, device=pose.device).unbind(1)
    lengths = (pose[:, :, parent] - pose[:, :, child]).norm(dim=-1)
    first = lengths[:, :1]
    return ((lengths[:, 1:] - first).abs() / (first + 1e-5)).sum(dim=-1).mean()
