"""SAG's training step on its own, and the same step as it is read at first sight."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import torch
from torch import Tensor

from benchmarks.plain import Plain
from benchmarks.scenes import furnished_room, motions, people
from sag.components import Network
from sag.methods import SAG
from sag.models.critics import Critic
from sag.skeleton import GTA_IM_19
from sag.types import Batch, Condition, DepthMap, Motion, Scene


class Step(SAG):
    """MDPC with its optimisers and no trainer around it.

    Args:
        network: sizes and choices of the networks.
        image_size: rows and columns of the picture.
        critic_steps: batches for the critics to each one for the generator.
    """

    trainer: Any = None

    def __init__(self, network: Network, image_size: tuple[int, int], critic_steps: int = 1) -> None:
        super().__init__(network=network, image_size=image_size, critic_steps=critic_steps)
        self._read()
        self.both = self.configure_optimizers()
        self.place = SimpleNamespace(total_batch_idx=0)
        self.trainer = SimpleNamespace(fit_loop=SimpleNamespace(epoch_loop=self.place))

    def _read(self) -> None:
        """Leaves the networks as they are."""

    def optimizers(self, use_pl_optimizer: bool = True) -> Any:
        """Of the generator and of the critics."""
        return self.both

    def manual_backward(self, loss: Tensor, *args: Any, **kwargs: Any) -> None:
        """Plain backward."""
        loss.backward()

    def log(self, *args: Any, **kwargs: Any) -> None:
        """Logs nothing."""

    def log_dict(self, *args: Any, **kwargs: Any) -> None:
        """Logs nothing."""

    def whole(self, batch: Batch) -> None:
        """As many critic steps as asked for, the last one with the generator's."""
        for number in range(self.critic_steps):
            self.place.total_batch_idx = number
            self.training_step(batch, number)

    def critics_alone(self, batch: Batch, fake: Motion, condition: Condition) -> None:
        """One step of all critics with their penalties, everything given."""
        self._train_critics(batch.motion, fake, condition, DepthMap(batch.scene.depth, batch.scene.intrinsics))


class PlainStep(Step):
    """The same step with every network read plainly and every critic encoding the picture for itself."""

    picture: Tensor | None = None
    only: str | None = None

    def _read(self) -> None:
        generator: Any = self.sampler.generator
        depth: Any = self.depth
        self.sampler.encoder = Plain(self.sampler.encoder)  # type: ignore[assignment]
        generator.trajectory, generator.pose = Plain(generator.trajectory), Plain(generator.pose)
        depth.decoder = Plain(depth.decoder)
        for critic in self.critics.values():
            critic.network = Plain(critic.network)

    @property
    def judges(self) -> dict[str, Critic]:
        """All critics, or the one whose turn it is."""
        return {name: c for name, c in self.critics.items() if self.only in (None, name)}

    def training_step(self, batch: Batch, batch_idx: int) -> None:
        """Keeps the picture for the critics."""
        self.picture = batch.scene.image
        super().training_step(batch, batch_idx)
        self.picture = None

    def _train_critics(self, real: Motion, fake: Motion, condition: Condition, scene: DepthMap) -> None:
        for name in self.critics:
            self.only = name
            if self.picture is not None and name != "context":
                with torch.no_grad():
                    condition = Condition(self.sampler.encoder(self.picture), condition.initial_pose)
            super()._train_critics(real, fake, condition, scene)
        self.only = None


def windows(count: int, image_size: tuple[int, int]) -> Batch:
    """A batch of people in furnished rooms, their pictures made of depth and grain."""
    rooms = [furnished_room(seed, image_size) for seed in range(count)]
    joints = torch.cat([motions(people(room, 1, seed), seed) for seed, room in enumerate(rooms)])
    depth = torch.stack([room.depth for room in rooms])
    grain = 0.05 * torch.randn(count, 3, *image_size, generator=torch.Generator().manual_seed(0))
    image = (1 / (1 + depth[:, None] / 4) + grain).clamp(0, 1)
    scene = Scene(image, depth, torch.zeros_like(depth, dtype=torch.bool), torch.stack([r.intrinsics for r in rooms]))
    index = torch.arange(count)
    return Batch(
        Motion.from_joints(joints, GTA_IM_19.root_index), scene, index, index, index, torch.eye(4).repeat(count, 1, 1)
    )


def both_steps(network: Network, image_size: tuple[int, int], critic_steps: int, motion: Motion) -> tuple[Step, Step]:
    """Ours and the plain reading, from the same weights."""
    made = []
    for kind in (Step, PlainStep):
        torch.manual_seed(0)
        step = kind(network, image_size, critic_steps)
        step.sampler.scale.fit(motion)
        made.append(step)
    return made[0], made[1]
