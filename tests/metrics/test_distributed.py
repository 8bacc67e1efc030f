"""Two processes say what one says, with a last batch of another size, and nothing is counted twice."""

from pathlib import Path
from typing import Any

import pytest
import torch
import torch.distributed
import torch.multiprocessing
from metric_inputs import asked, built, every_metric, fed, numbers, picked, toy_inputs, usual_settings
from torch import Tensor

from sag.metrics import MotionFID, NonCollisionRatio
from sag.metrics.fid.kid import MotionKID
from sag.models.erd import MotionEncoders
from sag.skeleton import GTA_IM_19
from sag.types import DepthMap

WINDOWS, BATCH = 22, 6
"""Batches of 6, 6, 6 and 4: one process has the first and the third, the other the second and the last."""


def metrics() -> dict[str, Any]:
    torch.manual_seed(0)
    encoders = MotionEncoders("gta_im_19", width=0.01).double().eval()
    return {
        "fid": MotionFID(encoders, GTA_IM_19.root_index),
        "kid": MotionKID(encoders, GTA_IM_19.root_index),
        "few": MotionKID(encoders, GTA_IM_19.root_index, most=9),
        "clear": NonCollisionRatio(GTA_IM_19.bone_index, frames=5),
    }


def wanderings(seed: int) -> Tensor:
    """Joints that wander about, three metres away."""
    steps = torch.randn(WINDOWS, 65, 19, 3, generator=torch.manual_seed(seed), dtype=torch.float64)
    return 0.02 * steps.cumsum(1) + torch.tensor([0, 0, 3])


def give(found: dict[str, Any], chosen: Tensor) -> None:
    """One batch of windows for every metric."""
    real, generated = wanderings(1), wanderings(2)
    depth = torch.linspace(2.5, 6, 64).expand(WINDOWS, 36, 64)
    focal = torch.tensor([[58.0, 0, 32], [0, 58, 18], [0, 0, 1]]).expand(WINDOWS, 3, 3)
    found["fid"].update(real[chosen], real=True)
    found["fid"].update(generated[chosen], real=False)
    for name in ("kid", "few"):
        found[name].update(real[chosen], real=True, index=chosen)
        if 0 in chosen:  # the second process has no generated motion of these at all
            found[name].update(generated, real=False, index=torch.arange(WINDOWS))
    found["clear"].update(generated[chosen].float(), DepthMap(depth[chosen], focal[chosen]), index=chosen)


def figures(found: dict[str, Any]) -> dict[str, float]:
    values = {name: metric.compute() for name, metric in found.items()}
    sizes = {key: float(distance.real) for key, distance in found["fid"].distances().items()}
    return {f"{name}/{key}": float(x) for name, each in values.items() for key, x in each.items()} | {
        f"clips/{key}": size for key, size in sizes.items()
    }


def one_of_two(rank: int, folder: str) -> None:
    """What a process does; figures are asked for twice, so that one asking must leave no trace."""
    torch.set_num_threads(1)
    torch.distributed.init_process_group("gloo", init_method=f"file://{folder}/meeting", rank=rank, world_size=2)
    found = metrics()
    first, second = torch.arange(WINDOWS).split(BATCH)[rank::2]
    give(found, first)
    half = figures(found)
    give(found, second)
    torch.save({"half": half, "whole": figures(found)}, Path(folder, f"{rank}.pt"))
    torch.distributed.destroy_process_group()


def test_two_processes_say_what_one_says(tmp_path):
    torch.multiprocessing.spawn(one_of_two, (str(tmp_path),), nprocs=2)
    first, second = (torch.load(tmp_path / f"{rank}.pt") for rank in (0, 1))
    assert first == second
    found = metrics()
    for name, batches in (("half", [range(12)]), ("whole", [range(12, 15), range(15, 22)])):
        for batch in batches:
            give(found, torch.tensor(batch))
        assert first[name] == pytest.approx(figures(found), rel=1e-12, abs=1e-12), name
    assert first["whole"] != pytest.approx(first["half"], rel=1e-3)


def every_figure_of_two(rank: int, folder: str) -> None:
    """What a process does: the first has windows 0, 1, 2, 6 and 7, the second 3, 4 and 5."""
    torch.set_num_threads(1)
    torch.distributed.init_process_group("gloo", init_method=f"file://{folder}/meeting", rank=rank, world_size=2)
    settings, inputs, found = usual_settings(), toy_inputs(), {}
    for kind in every_metric():
        metric = built(kind, settings)
        for first in (0, 6) if rank == 0 else (3,):
            metric.update(**asked(kind, picked(inputs, slice(first, first + 3))))
        found[kind.__name__] = numbers(metric.compute())
    torch.save(found, Path(folder, f"{rank}.pt"))
    torch.distributed.destroy_process_group()


def test_every_metric_says_in_two_processes_what_it_says_in_one(tmp_path):
    torch.multiprocessing.spawn(every_figure_of_two, (str(tmp_path),), nprocs=2)
    first, second = (torch.load(tmp_path / f"{rank}.pt") for rank in (0, 1))
    assert first == second
    settings, inputs = usual_settings(), toy_inputs()
    for kind in every_metric():
        alone = numbers(fed(built(kind, settings), inputs).compute())
        assert first[kind.__name__] == pytest.approx(alone, rel=1e-6, abs=1e-9), kind.__name__
