"""What the tests of both layouts ask of a folder that was written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter, minimum_filter

from sag.cli import main
from sag.data.base import MotionDataModule

CONFIGS = Path(__file__).parents[2] / "configs"


def write_by_command(layout: str, folder: Path, size: tuple[int, int], **options: float) -> None:
    """Two rooms with one recording each, written by `sag data rooms --layout`."""
    asked = {"rooms": 2, "recordings": 1, "workers": 1, **options}
    flags = [f"--{name}={value}" for name, value in asked.items()]
    assert main(["data", "rooms", "--layout", layout, str(folder), *flags, "--size", *map(str, size)]) == 0


def like(values: np.ndarray, truth: np.ndarray, slack: np.ndarray | float = 0.0) -> np.ndarray:
    """Whether each pixel is within the range of the true ones around it: a loader resamples what lies between."""
    around = (3, 3, *(1,) * (truth.ndim - 2))
    low, high = (f(truth.astype(float), around, mode="nearest") for f in (minimum_filter, maximum_filter))
    return (values >= low - slack) & (values <= high + slack)


def trains_and_tests(config: str, root: Path, module: MotionDataModule, folder: Path) -> bool:
    """Whether a tiny network fits and is tested by the data set's own config, with the cache that is there."""
    (folder / "tiny.yaml").write_text(
        f"""
model: {{init_args: {{network: {{width: 0.05}}}}}}
encoder_width: 0.05
data:
  init_args: {{root: {root}, cache_dir: {module.cache_dir}, image_size: {list(module.image_size)}, batch_size: 2}}
trainer: {{fast_dev_run: true, default_root_dir: {folder}, accelerator: cpu}}
"""
    )
    configs = [CONFIGS / "base.yaml", CONFIGS / "data" / config, folder / "tiny.yaml"]
    given = [part for path in configs for part in ("--config", str(path))]
    return all(main([stage, *given]) == 0 for stage in ("fit", "test"))
