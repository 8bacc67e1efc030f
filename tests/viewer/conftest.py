"""A trained run on toy data, for `sag view`."""

from pathlib import Path

import pytest
import yaml

from sag.checkpoints import WholeCheckpoints
from sag.components import Components, Network
from sag.methods import SAG


@pytest.fixture
def sweep(tmp_path: Path, toy) -> Path:
    """A folder of two runs that were trained for nothing but their normalisation."""
    for name in ("mdpc", "none"):
        switches = dict.fromkeys(("depth", "projection", "context"), False)
        settings = {"width": 0.05, "critic_norm": "layer"}
        config = {
            "components": switches,
            "model": {"class_path": "sag.methods.SAG", "init_args": {"network": settings}},
            "data": {"class_path": "toy_data.ToyDataModule", "init_args": {"cache_dir": str(toy.cache_dir)}},
        }
        method = SAG(Components(**switches), Network(**settings), image_size=toy.image_size)
        method.sampler.scale.fit(toy.training_motion)
        method.generator_steps += 1
        folder = tmp_path / "sweep" / name
        (folder / "checkpoints").mkdir(parents=True)
        (folder / "config.fit.yaml").write_text(yaml.safe_dump(config))
        (folder / "metrics.json").write_text("{}")
        WholeCheckpoints().save_checkpoint({"state_dict": method.state_dict()}, folder / "checkpoints/last.ckpt")
    return tmp_path / "sweep"
