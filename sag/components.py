"""The four letters of the ablation, and the only place that asks which of them are on.

Adding a fifth: a critic (or loss) of its own, a field here that is false by default, one `if` below, and
a row file in `configs/ablations/`.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from torch import nn

from sag.letters import row_name
from sag.losses import berhu
from sag.models.critic_networks import (
    BLOCKS,
    CONTEXT_BLOCKS,
    ContextCriticNetwork,
    CriticCondition,
    GraphCriticNetwork,
    TrajectoryCriticNetwork,
    condition_gain,
)
from sag.models.critics import (
    CROP_EVERY,
    ContextCritic,
    Critic,
    MotionCritic,
    PoseCritic,
    ProjectionCritic,
    TrajectoryCritic,
)
from sag.models.finishing import Bones, FinishedGenerator, KeptBones, Smooth
from sag.models.generators import (
    GeneratorSizes,
    JointGenerator,
    MotionGenerator,
    PoseSees,
    SeparateGenerator,
)
from sag.models.graph import Norm
from sag.models.noise import Kernel
from sag.models.scale import MotionScale, Units
from sag.models.scene_depth import ContextDepth, SceneDepth, SupervisedDepth
from sag.models.scene_encoder import BlindEncoder, DepthDecoder, EncoderStart, FeatureNorm, SceneEncoder
from sag.skeleton import Skeleton
from sag.types import FRAMES

LOSSES = ("depth", "trajectory", "pose", "motion", "projection", "context")
"""Every loss that a generator may pay, in some row."""


@dataclass(frozen=True)
class Components:
    """Which of the paper's components are on (Table 1).

    Attributes:
        separate: M, trajectory first and pose after it; off is CSGN's one generator for both.
        depth: D, the scene encoder is supervised by depth.
        projection: P, the projection critic.
        context: C, the context critic.
    """

    separate: bool = True
    depth: bool = True
    projection: bool = True
    context: bool = True

    @property
    def letters(self) -> str:
        """The row's name: `none`, `m`, `md`, ..., `mdpc`."""
        return row_name(asdict(self))


@dataclass(frozen=True)
class Network:
    """Sizes and choices of the networks; the defaults are the paper's or, where it is silent, ours.

    Attributes:
        width: factor on all channels.
        critic_norm: norm in the critics.
        critic_condition: whether f stands beside what a critic judges as it is, as in the paper, or balanced with it.
        kernel: of the Gaussian-process noise.
        units: what the networks reckon in.
        bones: whether a pose's joints are free, as in the paper, or its bones kept at their lengths in frame 0.
        smooth: frames to either side over which a drawn motion is averaged; 0 leaves frames free, as in the paper.
        crop_scale: size of the context critic's crops; 1 is the paper's.
        context_depth: the depth those crops are cut from when D is on.
        feature_grid: cells into which the encoder's last map is pooled; (1, 1) is ResNet's.
        feature_norm: how f is brought to scale.
        imagenet: local file with torchvision's ImageNet weights of ResNet-18, in which training starts.
        scene_encoder: checkpoint of another run in whose scene encoder training starts instead.
        pose_sees: what of the trajectory the pose generator is given: where the root is, or its velocities.
        blind: whether the scene feature is zero: the honest zero of scene awareness.
    """

    width: float = 1.0
    critic_norm: Norm = "batch"
    critic_condition: CriticCondition = "plain"
    kernel: Kernel = "exponential"
    units: Units = "zscore"
    bones: Bones = "free"
    smooth: int = 0
    crop_scale: float = 1.0
    context_depth: ContextDepth = "decoded"
    feature_grid: tuple[int, int] = (1, 1)
    feature_norm: FeatureNorm = "none"
    imagenet: Path | None = None
    scene_encoder: Path | None = None
    pose_sees: PoseSees = "places"
    blind: bool = False

    def __post_init__(self) -> None:
        """Takes the word that the option parser makes of `null` on a command line for what it means."""
        for start in ("imagenet", "scene_encoder"):
            if getattr(self, start) == Path("None"):
                object.__setattr__(self, start, None)

    def channels(self, *counts: int) -> tuple[int, ...]:
        """Channels at this width, at least 16 of each."""
        return tuple(max(min(16, n), round(n * self.width)) for n in counts)

    @property
    def generator_sizes(self) -> GeneratorSizes:
        """Channels of the generators."""
        paper = GeneratorSizes()
        trajectory, pose, feature = self.channels(paper.trajectory_noise, paper.pose_noise, paper.feature)
        return GeneratorSizes(trajectory, pose, feature, self.channels(*paper.blocks))


def build_encoder(network: Network) -> SceneEncoder | BlindEncoder:
    """The scene encoder; the same for all rows of the ablation, and none for the blind one."""
    if network.blind:
        return BlindEncoder(network.generator_sizes.feature)
    (width,) = network.channels(64)
    sizes = network.generator_sizes
    start = EncoderStart(network.imagenet, network.scene_encoder)
    return SceneEncoder(sizes.feature, width, network.feature_grid, network.feature_norm, start)


def build_generator(
    components: Components, network: Network, skeleton: Skeleton, scale: MotionScale
) -> MotionGenerator:
    """M decides: two generators in a row, or CSGN's one."""
    sizes, kernel = network.generator_sizes, network.kernel
    generator: MotionGenerator = (
        SeparateGenerator(sizes, skeleton, scale, kernel, network.pose_sees)
        if components.separate
        else JointGenerator(sizes, skeleton, scale, kernel)
    )
    finishes: list[nn.Module] = [Smooth(network.smooth)] if network.smooth else []
    finishes += [KeptBones(skeleton)] if network.bones == "kept" else []
    return FinishedGenerator(generator, finishes) if finishes else generator


def build_depth(components: Components, network: Network, image_size: tuple[int, int]) -> SceneDepth:
    """D decides: a decoder with its loss, or the data's own depth."""
    if not components.depth:
        return SceneDepth()
    (channels,) = network.channels(128)
    decoder = DepthDecoder(network.generator_sizes.feature, image_size, channels)
    return SupervisedDepth(decoder, berhu, network.context_depth)


def build_critics(
    components: Components, network: Network, skeleton: Skeleton, scale: MotionScale
) -> dict[str, Critic]:
    """Critics by name: M decides which judge the motion, P and C add one each."""
    feature = network.generator_sizes.feature
    blocks, norm = network.channels(*BLOCKS), network.critic_norm

    initial_pose = 3 * len(skeleton.joints)

    def gain(judged: int, condition: int) -> float:
        return condition_gain(network.critic_condition, judged, condition)

    def graph(judged: int, further: int = 0) -> GraphCriticNetwork:
        condition = feature + further
        return GraphCriticNetwork(judged + condition, skeleton, norm, blocks, gain(judged, condition))

    critics: dict[str, Critic] = {}
    if components.separate:
        condition = feature + initial_pose
        judge = TrajectoryCriticNetwork(3 + condition, norm, blocks, gain(3, condition))
        critics["trajectory"] = TrajectoryCritic(judge, scale)
        critics["pose"] = PoseCritic(graph(6), scale)
    else:
        critics["motion"] = MotionCritic(graph(3, initial_pose), scale)
    if components.projection:
        critics["projection"] = ProjectionCritic(graph(2), scale)
    if components.context:
        context = ContextCriticNetwork(len(range(0, FRAMES, CROP_EVERY)), norm, network.channels(*CONTEXT_BLOCKS))
        critics["context"] = ContextCritic(context, scale, network.crop_scale)
    return critics


def parameter_count(module: nn.Module) -> int:
    """Numbers that training changes."""
    return sum(p.numel() for p in module.parameters() if p.requires_grad)
