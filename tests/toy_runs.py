"""Trained runs on toy data, for what samples them."""

from collections.abc import Sequence
from pathlib import Path

import yaml
from toy_data import ToyDataModule

from sag.checkpoints import WholeCheckpoints
from sag.components import Components, Network
from sag.methods import SAG


def toy_sweep(folder: Path, toy: ToyDataModule, names: Sequence[str], trained: bool = True) -> Path:
    """A folder of runs that were trained for nothing but their normalisation."""
    for name in names:
        switches = dict.fromkeys(("depth", "projection", "context"), False)
        settings = {"width": 0.05, "critic_norm": "layer"}
        config = {
            "components": switches,
            "model": {"class_path": "sag.methods.SAG", "init_args": {"network": settings}},
            "data": {"class_path": "toy_data.ToyDataModule", "init_args": {"cache_dir": str(toy.cache_dir)}},
        }
        method = SAG(Components(**switches), Network(**settings), image_size=toy.image_size)
        method.sampler.scale.fit(toy.training_motion)
        if trained:
            method.generator_steps += 1
        run = folder / name
        (run / "checkpoints").mkdir(parents=True)
        (run / "config.fit.yaml").write_text(yaml.safe_dump(config))
        (run / "metrics.json").write_text("{}")
        WholeCheckpoints().save_checkpoint({"state_dict": method.state_dict()}, run / "checkpoints/last.ckpt")
    return folder
