"""The paper's networks as they are read at first sight: what `sag.models` must equal and is timed against.

Conditions are planes of channels, graph convolutions are ST-GCN's (a convolution to three times the channels, then the
adjacency), the context critic's last convolution is made in full and pooled after it, pictures stay channels first.
Each function takes a network of `sag` for its parameters and does its work in its own way.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor, nn

from sag.models.critic_networks import ContextCriticNetwork, GraphCriticNetwork, TrajectoryCriticNetwork
from sag.models.generators import PoseNetwork, TrajectoryNetwork
from sag.models.graph import SLOPE, GraphBlock, GraphConv
from sag.models.scene_encoder import DepthDecoder, SceneEncoder


def planes(x: Tensor, condition: Tensor | None) -> Tensor:
    """Values (b, c, ...) with a condition (b, e) repeated at every place behind their channels."""
    if condition is None:
        return x
    shape = (*condition.shape, *[1] * (x.dim() - 2))
    return torch.cat([x, condition.view(shape).expand(-1, -1, *x.shape[2:])], dim=1)


def norm(layer: nn.Module, x: Tensor) -> Tensor:
    """The norm of values (n, c, ...) in torch's own layout."""
    if isinstance(layer, nn.modules.batchnorm._BatchNorm):
        moments = (layer.running_mean, layer.running_var)
        return F.batch_norm(x, *moments, layer.weight, layer.bias, layer.training, layer.momentum or 0.0, layer.eps)
    return F.group_norm(x, 1, layer.weight, layer.bias, layer.eps) if isinstance(layer, nn.GroupNorm) else x


def graph_conv(conv: GraphConv, x: Float[Tensor, "b c v t"]) -> Float[Tensor, "b d w s"]:
    """ST-GCN's: convolves every node's frames for each partition, then sums over nodes by the adjacency."""
    kernels, channels = conv.weight.shape[:2]
    weight = conv.weight.flatten(0, 1)[:, :, None]
    y = F.conv2d(x, weight, None, (1, conv.stride), (0, conv.padding)).unflatten(1, (kernels, channels))
    return torch.einsum("bkdvt,kvw->bdwt", y, conv.adjacency) + conv.bias[:, None, None]


def graph_block(block: GraphBlock, x: Float[Tensor, "b c v t"]) -> Float[Tensor, "b d w s"]:
    """Activation, convolution, a norm of every node's frames, upsampling."""
    y = graph_conv(block.conv, F.leaky_relu(x, SLOPE))
    b, _, nodes, _ = y.shape
    y = norm(block.norm, y.transpose(1, 2).flatten(0, 1)).unflatten(0, (b, nodes)).transpose(1, 2)
    return y if isinstance(block.up, nn.Identity) else y.repeat_interleave(2, dim=-1)


def graph_critic(network: GraphCriticNetwork, view: Float[Tensor, "b j c t"], condition: Tensor) -> Tensor:
    """Tables 8 and 11."""
    x = planes(view.transpose(1, 2), condition)
    for block in network.blocks:
        x = graph_block(block, x)  # type: ignore[arg-type]
    return pooled(network, F.conv1d(F.leaky_relu(x[:, :, 0], SLOPE), network.out.weight, network.out.bias))


def pooled(network: Any, x: Float[Tensor, "b c *places"]) -> Float[Tensor, " b"]:
    """The score of a map's mean."""
    return network.score(x.flatten(2).mean(dim=-1))[:, 0]


def trajectory_critic(network: TrajectoryCriticNetwork, view: Float[Tensor, "b c t"], condition: Tensor) -> Tensor:
    """Table 10."""
    x = planes(view, condition)
    blocks: Any = network.blocks
    for _, conv, layer in blocks:
        x = norm(layer, F.conv1d(F.leaky_relu(x, SLOPE), conv.weight, conv.bias, conv.stride, conv.padding))
    return pooled(network, F.conv1d(F.leaky_relu(x, SLOPE), network.out.weight, network.out.bias))


def context_critic(network: ContextCriticNetwork, view: Float[Tensor, "b n h w"]) -> Tensor:
    """Table 9."""
    x = view
    blocks: Any = network.blocks
    for _, conv, layer in blocks:
        x = norm(layer, F.conv2d(F.leaky_relu(x, SLOPE), conv.weight, conv.bias, 2, 1))
    return pooled(network, F.conv2d(F.leaky_relu(x, SLOPE), network.out.weight, network.out.bias, padding=1))


def trajectory_generator(network: TrajectoryNetwork, noise: Float[Tensor, "b n 6"], condition: Tensor) -> Tensor:
    """Table 6."""
    x = planes(noise, condition)
    blocks: Any = network.blocks
    for number, (_, conv, layer, *_) in enumerate(blocks):
        x = norm(layer, F.conv1d(F.leaky_relu(x, SLOPE), conv.weight, conv.bias, 1, conv.padding))
        x = x.repeat_interleave(2, dim=-1) if number else x
    return F.conv1d(F.leaky_relu(x, SLOPE), network.out.weight, network.out.bias, padding=1).tanh()


def pose_generator(network: PoseNetwork, noise: Float[Tensor, "b n 6"], condition: Tensor) -> Tensor:
    """Table 7."""
    x = planes(noise, condition)[:, :, None]
    for block in network.blocks:
        x = graph_block(block, x)  # type: ignore[arg-type]
    return graph_conv(network.out, F.leaky_relu(x, SLOPE)).tanh().permute(0, 3, 2, 1)


def scene_encoder(network: SceneEncoder, image: Float[Tensor, "b 3 h w"]) -> Float[Tensor, "b f"]:
    """ResNet-18 with its maps channels first."""
    pixels = (image - network.mean) / network.std
    return network.fc(F.adaptive_avg_pool2d(network.resnet(pixels), network.grid).flatten(1))


def depth_decoder(network: DepthDecoder, feature: Float[Tensor, "b f"]) -> Float[Tensor, "b h w"]:
    """The decoder with its maps channels first."""
    x = F.relu(network.fc(feature)).view(-1, network.channels, *network.sizes[0])
    for block, size in zip(network.blocks, network.sizes[1:]):
        x = block(F.interpolate(x, size, mode="nearest"))
    return F.interpolate(4 * F.softplus(network.out(x)), network.image_size, mode="bilinear")[:, 0]


READINGS: dict[type[nn.Module], Callable[..., Tensor]] = {
    GraphCriticNetwork: graph_critic,
    TrajectoryCriticNetwork: trajectory_critic,
    ContextCriticNetwork: context_critic,
    TrajectoryNetwork: trajectory_generator,
    PoseNetwork: pose_generator,
    SceneEncoder: scene_encoder,
    DepthDecoder: depth_decoder,
}
"""The plain reading of each network."""


class Plain(nn.Module):
    """A network's own copy, its parameters channels first, read plainly.

    Args:
        network: to copy; one of `READINGS`.
    """

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = copy.deepcopy(network)
        self.reading = READINGS[type(network)]
        for parameter in self.network.parameters():
            parameter.data = parameter.data.contiguous()

    def forward(self, *given: Tensor) -> Tensor:
        """What the network makes of it."""
        return self.reading(self.network, *given)
