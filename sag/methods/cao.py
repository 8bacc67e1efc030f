"""Cao et al.: a goal in the picture, a path to it, the pose along the path (ECCV 2020)."""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Generator, Tensor, nn

from sag.components import Network, build_encoder
from sag.geometry.camera import project
from sag.methods.base import Method
from sag.methods.encoder_start import start_encoder
from sag.methods.stages import check_shares, stages_due
from sag.methods.terms import record
from sag.models.cao import path_net, pose_net
from sag.models.cao.blocks import Seen
from sag.models.cao.goal_net import BLOCKS, LATENT, GoalNet, goal_loss
from sag.models.cao.heat_maps import heat_maps, map_size, peak
from sag.models.scale import MotionScale
from sag.processes import drawn
from sag.scoring import Evaluation
from sag.types import Batch, Condition, Motion


@dataclass(frozen=True)
class CaoRecipe:
    """How the three networks are trained.

    Attributes:
        learning_rates: of each stage's Adam; 1e-4 for GoalNet is not ours, the others are.
        betas: of all three Adams.
        divergence: weight of GoalNet's KL divergence; ours.
        stages: share of the run's batches that each stage gets; ours.
    """

    learning_rates: tuple[float, float, float] = (1e-4, 5e-4, 5e-4)
    betas: tuple[float, float] = (0.9, 0.999)
    divergence: float = 0.01
    stages: tuple[float, float, float] = (2.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        check_shares(self.stages)


class Cao(Method):
    """Long-term human motion prediction with scene context (Cao et al., ECCV 2020), which has no public model code.

    GoalNet draws where in the picture the person will be after the last frame; PathNet lays the root's path to
    there; PoseNet refines the given pose along the path. All chance is in the goal: given one, the motion is fixed,
    which is why the paper's Figure 7 has it at 0. Each network learns from the truth of the one before it, the path
    from true goals and the pose from true paths, so the three are trained one after another in one fit.

    *Published*: the three networks and what each is for and sees; a CVAE over heat maps, an hourglass, a Transformer
    that starts from the pose moved along the path. GoalNet's layers, 200 latent numbers, heat maps of a quarter of the
    picture's size, squared error with KL divergence and Adam at 1e-4 are as a public GoalNet has them (Yang et al.,
    ROBOVIS 2025). *Rebuilt from the description*: the sizes of hourglass and Transformer (those of the papers that
    introduced them), how the hourglass's maps become a path in metres, L1 errors of path and pose. *Ours*: only the
    given frame is seen, as in this task, where the original sees a second of history; knots every 8 frames and a
    spline between them; f and the initial pose told to the networks, as to every system that is compared (f's encoder
    learns with GoalNet, then rests); that GoalNet's encoder sees the true goal in training; what `CaoRecipe` calls
    ours. Goals, and so paths, stay inside the picture.

    Args:
        network: sizes and choices of the networks.
        skeleton: name of the skeleton; the command line takes it from the data.
        evaluation: the protocol of testing.
        recipe: how the networks are trained.
    """

    stage_steps: Tensor  # of GoalNet, PathNet and PoseNet

    def __init__(
        self,
        network: Network = Network(),  # noqa: B008 (frozen)
        skeleton: str = "gta_im_19",
        evaluation: Evaluation = Evaluation(),  # noqa: B008 (frozen)
        recipe: CaoRecipe = CaoRecipe(),
    ) -> None:
        super().__init__(skeleton, evaluation)
        self.automatic_optimization = False
        self.network, self.recipe = network, recipe
        joints, feature = len(self.skeleton.joints), network.generator_sizes.feature
        told = feature + 3 * joints
        hourglass, token, latent = network.channels(path_net.CHANNELS, pose_net.CHANNELS, LATENT)
        self.scale = MotionScale(joints, self.skeleton.root_index, network.units)
        self.encoder = build_encoder(network)
        self.goal_net = GoalNet(joints, feature, network.channels(*BLOCKS), latent)
        self.path_net = path_net.PathNet(joints, told, hourglass)
        self.pose_net = pose_net.PoseNet(self.scale, joints, told, token)
        self.register_buffer("stage_steps", torch.zeros(3, dtype=torch.int64))

    @property
    def generator_steps(self) -> Tensor:
        """Steps of training taken by all three networks together."""
        return self.stage_steps.sum()

    @property
    def trained(self) -> bool:
        """Whether each of the three networks has taken a step."""
        return bool((self.stage_steps > 0).all())

    def begin(self) -> None:
        """Loads what the scene encoder starts from, and says what that is."""
        self.print(f"the scene encoder starts from {start_encoder(self.encoder)}")

    def prepare(self, motion: Motion) -> None:
        """Takes normalisation from the training split's motion."""
        self.scale.fit(motion)

    def _learning(self, stage: int) -> tuple[nn.Module, ...]:
        """What learns in a stage; the scene encoder learns with GoalNet."""
        return ((self.encoder, self.goal_net), (self.path_net,), (self.pose_net,))[stage]

    def configure_optimizers(self) -> list[torch.optim.Optimizer]:
        """One Adam for each stage."""
        return [
            torch.optim.Adam([p for m in self._learning(stage) for p in m.parameters()], rate, self.recipe.betas)
            for stage, rate in enumerate(self.recipe.learning_rates)
        ]

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """A step of the stage that is due; where a batch spans the end of one stage, of the next as well."""
        for stage in stages_due(self.trainer, self.recipe.stages):
            self.eval()
            for module in self._learning(stage):
                module.train()
            with torch.set_grad_enabled(stage == 0):
                seen = self._seen(batch)
            losses = (self._goal_losses, self._path_losses, self._pose_losses)[stage](seen, batch)
            record(self, {f"train/{name}": loss for name, loss in losses.items()})
            self._step(stage, sum(losses.values()))
            self.stage_steps[stage] += 1
        self.log("train/generator_step", self.generator_steps.float())

    def _goal_losses(self, seen: Seen, batch: Batch) -> dict[str, Tensor]:
        goal = self._goal_map(seen, self._pixels(batch, batch.motion.roots[:, -1]))
        noise = drawn(self._latents, len(batch))
        predicted, mean, log_variance = self.goal_net(seen, goal, noise)
        error, divergence = goal_loss(predicted, goal[:, 0], mean, log_variance)
        return {"goal": error, "divergence": self.recipe.divergence * divergence}

    def _path_losses(self, seen: Seen, batch: Batch) -> dict[str, Tensor]:
        path = self._path(seen, batch, self._pixels(batch, batch.motion.roots[:, -1]))
        return {"path": F.l1_loss(path, batch.motion.trajectory[:, 1:])}

    def _pose_losses(self, seen: Seen, batch: Batch) -> dict[str, Tensor]:
        path = self.path_net.spline.smoothed(batch.motion.trajectory)
        motion = self.pose_net(seen, batch.motion, path)
        return {"pose": F.l1_loss(motion.joints, batch.motion.joints)}

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        """One motion for each window, to a goal that GoalNet draws."""
        seen = self._seen(batch)
        latent = self._latents(len(batch), generator)
        return self._continued(seen, batch, peak(self.goal_net.sample(seen, latent)))

    def draw(self, count: int, generator: Generator) -> None:
        """Draws GoalNet's latents, and leaves them."""
        self._latents(count, generator)

    def _latents(self, count: int, generator: Generator | None = None) -> Tensor:
        return torch.randn(count, self.goal_net.latent, generator=generator, device=self.device)

    def sample_to(self, batch: Batch, goals: Float[Tensor, "b 3"]) -> Motion:
        """The motion of each window to a goal that is given: always the same one.

        Args:
            batch: windows; nothing but the picture and frame 0 is looked at.
            goals: where the root is to be in the last frame, metres, camera frame of frame 0. They are seen as places
                in the picture, those outside it as the nearest in it, so their depth is PathNet's to tell.
        """
        return self._continued(self._seen(batch), batch, self._pixels(batch, goals))

    def _continued(self, seen: Seen, batch: Batch, pixels: Tensor) -> Motion:
        return self.pose_net(seen, batch.motion, self._path(seen, batch, pixels))

    def _path(self, seen: Seen, batch: Batch, pixels: Tensor) -> Tensor:
        return self.path_net(seen, self._goal_map(seen, pixels), batch.motion.start, batch.scene.intrinsics)

    def _seen(self, batch: Batch) -> Seen:
        """What is known at frame 0; a blind network sees a grey picture."""
        image = torch.full_like(batch.scene.image, 0.5) if self.network.blind else batch.scene.image
        joints = project(batch.motion.joints[:, 0], batch.scene.intrinsics)
        condition = Condition(self.encoder(image), self.scale.initial_pose(batch.motion))
        return Seen(image, heat_maps(joints, map_size(*image.shape[-2:])), condition)

    def _pixels(self, batch: Batch, goals: Tensor) -> Tensor:
        """Picture coordinates (pixels) of places in space, inside the picture."""
        rows, columns = batch.scene.image.shape[-2:]
        return project(goals, batch.scene.intrinsics).clamp_min(0).minimum(goals.new_tensor([columns, rows]))

    def _goal_map(self, seen: Seen, pixels: Tensor) -> Tensor:
        return heat_maps(pixels[:, None], (seen.joints.shape[-2], seen.joints.shape[-1]))
