import numpy as np
import pytest
import torch
import torch.nn.functional as F
from torch import Tensor

from sag.models.graph import GraphBlock, GraphConv, normalization, partitions
from sag.skeleton import GTA_IM_19, PROX_16, SKELETONS

PAIRS = [(0, 0), (0, 1), (1, 1), (1, 2), (2, 3), (3, 2), (2, 1), (1, 0)]


def plain(conv: GraphConv, x: Tensor) -> Tensor:
    """The formula, one partition and one node at a time."""
    kernels, source, target = conv.adjacency.shape
    columns = []
    for w in range(target):
        y = 0
        for k in range(kernels):
            mixed = sum(conv.adjacency[k, v, w] * x[:, v] for v in range(source))
            y = y + F.conv1d(mixed, conv.weight[k], None, conv.stride, conv.padding)
        columns.append(y + conv.bias[:, None])
    return torch.stack(columns, dim=1)


@pytest.mark.parametrize(("source", "target"), PAIRS)
@pytest.mark.parametrize(("stride", "padding"), [(1, 1), (2, 0), (2, 1)])
def test_values_and_gradients_are_the_plain_form(source: int, target: int, stride: int, padding: int) -> None:
    levels = GTA_IM_19.levels
    conv = GraphConv(3, 4, levels[source], levels[target], stride, padding).double()
    x = torch.randn(2, len(levels[source].nodes), 3, 9, dtype=torch.float64, requires_grad=True)
    fast, slow = conv(x), plain(conv, x)
    assert torch.allclose(fast, slow, atol=1e-12)
    parameters = (x, *conv.parameters())
    weight = torch.randn_like(fast)
    for a, b in zip(
        torch.autograd.grad((fast * weight).sum(), parameters), torch.autograd.grad((slow * weight).sum(), parameters)
    ):
        assert torch.allclose(a, b, atol=1e-10)


def test_a_condition_is_channels_that_are_the_same_everywhere() -> None:
    levels = GTA_IM_19.levels
    conv = GraphConv(7, 5, levels[0], levels[1]).double()
    x = torch.randn(2, 19, 3, 65, dtype=torch.float64, requires_grad=True)
    condition = torch.randn(2, 4, dtype=torch.float64, requires_grad=True)
    beside = torch.cat([x, condition[:, None, :, None].expand(-1, 19, -1, 65)], dim=2)
    given_apart, set_beside = conv(x, condition), conv(beside)
    assert torch.allclose(given_apart, set_beside, atol=1e-12)
    parameters = (x, condition, *conv.parameters())
    weight = torch.randn_like(set_beside)
    for a, b in zip(
        torch.autograd.grad((given_apart * weight).sum(), parameters),
        torch.autograd.grad((set_beside * weight).sum(), parameters),
    ):
        assert torch.allclose(a, b, atol=1e-10)


@pytest.mark.parametrize("name", SKELETONS)
@pytest.mark.parametrize(("source", "target"), PAIRS)
def test_partitions_cover_each_node_once(name: str, source: int, target: int) -> None:
    levels = SKELETONS[name].levels
    parts = partitions(levels[source], levels[target])
    assert ((parts > 0).sum(0) <= 1).all()
    sums = parts.sum(1)
    assert np.all(np.isclose(sums, 1) | (sums == 0))
    assert np.allclose(sums[0], 1)


def test_adjacency_starts_asymmetric_and_learns() -> None:
    levels = PROX_16.levels
    conv = GraphConv(2, 2, levels[0], levels[0])
    mirror = list(PROX_16.mirror)
    assert not torch.allclose(conv.adjacency, conv.adjacency[:, mirror][:, :, mirror])
    conv(torch.randn(1, 16, 2, 4)).sum().backward()
    assert conv.adjacency.grad.abs().sum() > 0


@pytest.mark.parametrize("kind", ["batch", "layer", "none"])
def test_every_norm_leaves_the_shape(kind: str) -> None:
    assert normalization(kind, 6)(torch.randn(4, 6, 5)).shape == (4, 6, 5)


@pytest.mark.parametrize("kind", ["layer", "none"])
def test_samples_do_not_mix_without_batch_norm(kind: str) -> None:
    levels = GTA_IM_19.levels
    block = GraphBlock(GraphConv(3, 4, levels[0], levels[1]), kind)
    x = torch.randn(3, 19, 3, 8)
    together, alone = block(x)[1], block(x[1:2])[0]
    assert torch.allclose(together, alone, atol=1e-6)
