"""A trained run on toy data, for `sag view`."""

from pathlib import Path

import pytest
from toy_runs import toy_sweep


@pytest.fixture
def sweep(tmp_path: Path, toy) -> Path:
    """A folder of two runs that were trained for nothing but their normalisation."""
    return toy_sweep(tmp_path / "sweep", toy, ("mdpc", "none"))
