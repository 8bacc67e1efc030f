"""Every rewrite equals the plain reading of the paper: values and gradients, through the penalty's second order too."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor, nn

from benchmarks.plain import Plain, graph_conv
from sag.losses import gradient_penalty
from sag.models.critic_networks import ContextCriticNetwork, GraphCriticNetwork, TrajectoryCriticNetwork
from sag.models.generators import PoseNetwork, TrajectoryNetwork
from sag.models.graph import GraphConv
from sag.models.pooled import PooledConv2d
from sag.models.scene_encoder import DepthDecoder, SceneEncoder
from sag.models.temporal import TemporalConv
from sag.skeleton import GTA_IM_19, SKELETONS

PAIRS = [(0, 0), (0, 1), (1, 1), (1, 2), (2, 2), (2, 3), (3, 3), (3, 2), (2, 1), (1, 0)]
BLOCKS = (4, 6, 5, 7, 8)
NORMS = ["batch", "layer", "none"]


def random(*shape: int) -> Tensor:
    return torch.randn(*shape, dtype=torch.float64)


def alike(fast: Tensor, plain: Tensor) -> bool:
    return torch.allclose(fast, plain, rtol=1e-10, atol=1e-10)


def gradients(loss: Tensor, network: nn.Module, *given: Tensor) -> dict[str, Tensor]:
    named = {f"given {i}": x for i, x in enumerate(given)} | dict(network.named_parameters())
    found = torch.autograd.grad(loss, list(named.values()))
    return dict(zip(named, found))


def assert_alike(fast: nn.Module, *given: Tensor) -> None:
    """Values, and gradients of a random sum of them by parameters and by what is given."""
    plain = Plain(fast)
    given = tuple(x.requires_grad_() for x in given)
    ours, theirs = fast(*given), plain(*given)
    assert ours.shape == theirs.shape and alike(ours, theirs)
    weight = torch.randn_like(theirs)
    found = gradients((ours * weight).sum(), fast, *given)
    wanted = gradients((theirs * weight).sum(), plain.network, *given)
    for name in wanted:
        assert alike(found[name], wanted[name]), name


def assert_penalties_alike(fast: nn.Module, view: Tensor, *condition: Tensor) -> None:
    """The penalty and its gradients by parameters: the second order."""
    plain = Plain(fast)
    fake, losses = torch.randn_like(view), []
    for network in (fast, plain):
        torch.manual_seed(1)
        losses.append(gradient_penalty(lambda x, net=network: net(x, *condition), view, fake, 0.1))
    assert alike(*losses)
    parameters = [dict(n.named_parameters()) for n in (fast, plain.network)]
    found, wanted = (
        torch.autograd.grad(loss, list(p.values()), allow_unused=True, materialize_grads=True)
        for loss, p in zip(losses, parameters)
    )
    assert any(x.abs().max() > 1e-6 for x in wanted)
    for name, a, b in zip(parameters[0], found, wanted):
        assert alike(a, b), name


@pytest.mark.parametrize("skeleton", SKELETONS)
@pytest.mark.parametrize("norm", NORMS)
def test_graph_critic(norm: str, skeleton: str) -> None:
    body = SKELETONS[skeleton]
    network = GraphCriticNetwork(5 + 3, body, norm, BLOCKS).double()
    view, condition = random(3, len(body.joints), 5, 65), random(3, 3)
    assert_alike(network, view, condition)
    assert_penalties_alike(network, view.detach(), condition)


@pytest.mark.parametrize("norm", NORMS)
def test_trajectory_critic(norm: str) -> None:
    network = TrajectoryCriticNetwork(3 + 4, norm, BLOCKS).double()
    view, condition = random(3, 3, 64), random(3, 4)
    assert_alike(network, view, condition)
    assert_penalties_alike(network, view.detach(), condition)


@pytest.mark.parametrize("size", [(72, 128), (18, 32), (9, 7), (8, 1), (1, 1)])
@pytest.mark.parametrize("norm", NORMS)
def test_context_critic(norm: str, size: tuple[int, int]) -> None:
    network = ContextCriticNetwork(3, norm, (4, 5, 6, 7)).double()
    view = random(3, 3, *size)
    assert_alike(network, view)
    assert_penalties_alike(network, view.detach())


@pytest.mark.parametrize("training", [True, False])
def test_generators(training: bool) -> None:
    trajectory = TrajectoryNetwork(6 + 4, BLOCKS).double().train(training)
    assert_alike(trajectory, random(3, 6, 6), random(3, 4))
    pose = PoseNetwork(6 + 4, BLOCKS, GTA_IM_19).double().train(training)
    assert_alike(pose, random(3, 6, 6), random(3, 4))


@pytest.mark.parametrize("grid", [(1, 1), (2, 3)])
def test_scene_encoder(grid: tuple[int, int]) -> None:
    assert_alike(SceneEncoder(6, width=4, grid=grid).double(), torch.rand(2, 3, 72, 128, dtype=torch.float64))


@pytest.mark.parametrize("size", [(72, 128), (50, 70)])
def test_depth_decoder(size: tuple[int, int]) -> None:
    assert_alike(DepthDecoder(6, size, channels=8).double(), random(2, 6))


@pytest.mark.parametrize(("source", "target"), PAIRS)
@pytest.mark.parametrize(("stride", "padding"), [(1, 1), (1, 0), (2, 0), (2, 1)])
@pytest.mark.parametrize("frames", [3, 8, 9])
def test_graph_convolution(source: int, target: int, stride: int, padding: int, frames: int) -> None:
    levels = GTA_IM_19.levels
    conv = GraphConv(3, 4, levels[source], levels[target], stride, padding).double()
    x = random(2, len(levels[source].nodes), 3, frames).requires_grad_()
    ours, theirs = conv(x), graph_conv(conv, x.transpose(1, 2)).transpose(1, 2)
    assert alike(ours, theirs)
    weight = torch.randn_like(theirs)
    found, wanted = (gradients((y * weight).sum(), conv, x) for y in (ours, theirs))
    assert all(alike(found[name], wanted[name]) for name in wanted)


def test_both_orders_of_a_graph_convolution_occur_in_it() -> None:
    levels = GTA_IM_19.levels
    orders = {GraphConv(3, 4, levels[a], levels[b])._mixes_first(9) for a, b in PAIRS}
    assert orders == {True, False}


@pytest.mark.parametrize("frames", [1, 2, 3, 7])
@pytest.mark.parametrize(("stride", "padding"), [(1, 1), (2, 1)])
def test_temporal_convolution_is_torchs(frames: int, stride: int, padding: int) -> None:
    conv = TemporalConv(3, 4, stride, padding).double()
    x = random(2, 3, frames)
    wanted = nn.functional.conv1d(x, conv.weight, conv.bias, stride, padding)
    assert alike(conv(x), wanted)
    own, condition = x[:, :2], random(2, 1)
    beside = torch.cat([own, condition[..., None].expand(-1, -1, frames)], dim=1)
    assert alike(conv(own, condition), nn.functional.conv1d(beside, conv.weight, conv.bias, stride, padding))


def test_second_derivatives_of_a_temporal_convolution_are_right() -> None:
    conv = TemporalConv(2, 3, 2, 1).double()
    given = (random(1, 1, 5).requires_grad_(), random(1, 1).requires_grad_())
    assert torch.autograd.gradgradcheck(lambda x, condition: conv(x, condition).tanh(), given)


@pytest.mark.parametrize("size", [(1, 1), (1, 4), (5, 1), (2, 2), (9, 16)])
def test_pooled_convolution_is_exact_at_any_size(size: tuple[int, int]) -> None:
    conv = PooledConv2d(3, 5, 3, padding=1).double()
    x = random(2, 3, *size)
    wanted = nn.functional.conv2d(x, conv.weight, conv.bias, padding=1).mean(dim=(-2, -1))
    assert alike(conv(x), wanted)


def test_weights_have_torchs_names_and_shapes() -> None:
    conv, norm = TemporalConv(3, 4), TrajectoryCriticNetwork(7, "batch", BLOCKS).blocks[0][2]
    assert {n: x.shape for n, x in conv.state_dict().items()} == {
        n: x.shape for n, x in nn.Conv1d(3, 4, 3).state_dict().items()
    }
    assert list(norm.state_dict()) == list(nn.BatchNorm1d(4).state_dict())
