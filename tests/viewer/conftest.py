"""Trained runs on toy data, for `sag view`."""

from pathlib import Path

import pytest
from toy_runs import toy_run


@pytest.fixture
def sweep(tmp_path: Path, toy) -> Path:
    """A folder of two runs."""
    for name in ("mdpc", "none"):
        toy_run(tmp_path / "sweep" / name, toy)
    return tmp_path / "sweep"
