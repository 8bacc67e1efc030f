"""What is left of the networks when training is over: a picture and a first pose in, motions out."""

from __future__ import annotations

from torch import Generator, nn

from sag.models.generators import MotionGenerator
from sag.models.precision import full_precision
from sag.models.scale import MotionScale
from sag.models.scene_encoder import BlindEncoder, SceneEncoder
from sag.types import Condition, Motion, Scene


class Sampler(nn.Module):
    """p(X|S): scene encoder and generator. Depth, camera and critics are not needed to sample.

    Args:
        encoder: picture to f.
        generator: f, initial pose and noise to motion.
        scale: units, shared with the generator.
    """

    def __init__(self, encoder: SceneEncoder | BlindEncoder, generator: MotionGenerator, scale: MotionScale) -> None:
        super().__init__()
        self.encoder = encoder
        self.generator = generator
        self.scale = scale

    def condition(self, scene: Scene, given: Motion) -> Condition:
        """What generator and critics are told: f of the picture, and frame 0 of `given`."""
        return Condition(self.encoder(scene.image), self.scale.initial_pose(given))

    def forward(self, scene: Scene, given: Motion, generator: Generator | None = None) -> Motion:
        """One motion for each window, 65 frames, the first as given."""
        return self.several(scene, given, 1, generator)[0]

    def several(self, scene: Scene, given: Motion, count: int, generator: Generator | None = None) -> list[Motion]:
        """So many motions for each window; the picture is looked at once."""
        condition = self.condition(scene, given)
        noises = (self.generator.noise(len(given.start), generator) for _ in range(count))
        with full_precision(condition.feature):
            return [self.generator(condition, given, noise) for noise in noises]
