"""Tables 6 to 11 of the paper, row by row, at its own sizes."""

import pytest
import torch
from torch import nn

from sag.components import Components, Network, build_critics, build_generator
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19
from sag.types import Condition, Motion

TABLES = {
    "6 trajectory generator": [
        ((569, 1, 6), (512, 1, 4)),
        ((512, 1, 4), (256, 1, 8)),
        ((256, 1, 8), (128, 1, 16)),
        ((128, 1, 16), (64, 1, 32)),
        ((64, 1, 32), (32, 1, 64)),
        ((32, 1, 64), (3, 1, 64)),
    ],
    "7 pose generator": [
        ((1529, 1, 6), (512, 5, 4)),
        ((512, 5, 4), (256, 5, 8)),
        ((256, 5, 8), (128, 11, 16)),
        ((128, 11, 16), (64, 11, 32)),
        ((64, 11, 32), (32, 19, 64)),
        ((32, 19, 64), (3, 19, 64)),
    ],
    "8 projection critic": [
        ((258, 19, 65), (64, 11, 65)),
        ((64, 11, 65), (64, 11, 32)),
        ((64, 11, 32), (128, 5, 16)),
        ((128, 5, 16), (256, 5, 8)),
        ((256, 5, 8), (512, 1, 4)),
        ((512, 1, 4), (512, 1, 1)),
    ],
    "9 context critic": [
        ((9, 72, 128), (64, 36, 64)),
        ((64, 36, 64), (128, 18, 32)),
        ((128, 18, 32), (256, 9, 16)),
        ((256, 9, 16), (512, 1, 1)),
    ],
    "10 trajectory critic": [
        ((316, 1, 64), (64, 1, 64)),
        ((64, 1, 64), (64, 1, 32)),
        ((64, 1, 32), (128, 1, 16)),
        ((128, 1, 16), (256, 1, 8)),
        ((256, 1, 8), (512, 1, 4)),
        ((512, 1, 4), (512, 1, 1)),
    ],
    "11 pose critic": [
        ((262, 19, 65), (64, 11, 65)),
        ((64, 11, 65), (64, 11, 32)),
        ((64, 11, 32), (128, 5, 16)),
        ((128, 5, 16), (256, 5, 8)),
        ((256, 5, 8), (512, 1, 4)),
        ((512, 1, 4), (512, 1, 1)),
    ],
}
"""(channels, nodes, frames) into and out of each row; row Out pools."""

ROWS = [(table, row) for table, rows in TABLES.items() for row in range(len(rows))]


def table_shape(layout: str, tensors: tuple[torch.Tensor, ...]) -> tuple[int, ...]:
    """The shape as the tables print it; a condition given apart counts as channels."""
    x = tensors[0]
    shape = tuple(x.shape[1:])
    if len(shape) == 1:
        return (*shape, 1, 1)
    if layout == "pictures":
        return shape
    channels, frames = shape[-2:]
    nodes = shape[0] if len(shape) == 3 else 1
    return channels + sum(c.shape[1] for c in tensors[1:]), nodes, frames


def watched(network: nn.Module, run, layout: str) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Shapes into and out of every block and the last convolution while `run` runs."""
    seen = []

    def note(module: nn.Module, given: tuple, made: torch.Tensor) -> None:
        seen.append((table_shape(layout, given), table_shape(layout, (made,))))

    hooks = [module.register_forward_hook(note) for module in (*network.blocks, network.out)]
    run()
    for hook in hooks:
        hook.remove()
    return seen


@pytest.fixture(scope="module")
def shapes() -> dict[str, list]:
    scale = MotionScale(19, GTA_IM_19.root_index)
    generator = build_generator(Components(), Network(), GTA_IM_19, scale).eval()
    critics = build_critics(Components(), Network(), GTA_IM_19, scale)
    given = Motion(torch.zeros(2, 3), torch.zeros(2, 65, 3), torch.zeros(2, 65, 19, 3))
    condition = Condition(torch.zeros(2, 256), torch.zeros(2, 57))

    def generate() -> None:
        generator(condition, given, generator.noise(2))

    views = {
        "projection": (torch.randn(2, 19, 2, 65), "8 projection critic"),
        "context": (torch.randn(2, 9, 72, 128), "9 context critic"),
        "trajectory": (torch.randn(2, 3, 64), "10 trajectory critic"),
        "pose": (torch.randn(2, 19, 6, 65), "11 pose critic"),
    }
    found = {
        "6 trajectory generator": watched(generator.trajectory, generate, "frames"),
        "7 pose generator": watched(generator.pose, generate, "frames"),
    }
    for name, (view, table) in views.items():
        critic = critics[name].eval()
        layout = "pictures" if name == "context" else "frames"
        found[table] = watched(critic.network, lambda c=critic, v=view: c(v, condition), layout)
    return found


@pytest.mark.parametrize(("table", "row"), ROWS)
def test_row_of_the_paper(shapes: dict, table: str, row: int) -> None:
    assert shapes[table][row] == TABLES[table][row]


@pytest.mark.parametrize("table", TABLES)
def test_no_row_is_missing_or_added(shapes: dict, table: str) -> None:
    assert len(shapes[table]) == len(TABLES[table])


def test_graph_critics_take_the_condition_as_channels() -> None:
    critics = build_critics(Components(), Network(), GTA_IM_19, MotionScale(19, 12))
    first = {name: critics[name].network.blocks[0].conv.weight.shape[2] for name in ("projection", "pose")}
    assert first == {"projection": 258, "pose": 262}
