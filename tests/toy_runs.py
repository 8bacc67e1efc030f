"""Folders of runs on toy data that were trained for nothing but their normalisation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import yaml
from torch import nn
from toy_data import ToyDataModule

from sag.checkpoints import WholeCheckpoints
from sag.components import Components, Network
from sag.methods import SAG


def toy_run(folder: Path, toy: ToyDataModule, depth: bool = False, trained: bool = True, average: float = 0.0) -> Path:
    """Writes a run as training leaves it, with a depth decoder or an average or without, and gives its folder back."""
    switches = {"depth": depth, "projection": False, "context": False}
    settings = {"width": 0.05, "critic_norm": "layer"}
    config = {
        "components": switches,
        "model": {"class_path": "sag.methods.SAG", "init_args": {"network": settings, "average": average}},
        "data": {"class_path": "toy_data.ToyDataModule", "init_args": {"cache_dir": str(toy.cache_dir)}},
    }
    method = SAG(Components(**switches), Network(**settings), image_size=toy.image_size, average=average)
    method.sampler.scale.fit(toy.training_motion)
    for averaged in method.averaged:
        averaged.module.scale.load_state_dict(method.sampler.scale.state_dict())
        averaged.module.generator.apply(_moved)
    if trained:
        method.generator_steps += 1
    (folder / "checkpoints").mkdir(parents=True)
    (folder / "config.fit.yaml").write_text(yaml.safe_dump(config))
    (folder / "metrics.json").write_text("{}")
    WholeCheckpoints().save_checkpoint({"state_dict": method.state_dict()}, folder / "checkpoints/last.ckpt")
    return folder


def _moved(module: nn.Module) -> None:
    """Takes an average away from the weights that it is of."""
    for parameter in module.parameters(recurse=False):
        parameter.mul_(0.5)


def toy_sweep(folder: Path, toy: ToyDataModule, names: Sequence[str], trained: bool = True) -> Path:
    """A folder of such runs without a depth decoder."""
    for name in names:
        toy_run(folder / name, toy, trained=trained)
    return folder
