"""Shapes and types of every annotated function are checked while the tests run."""

import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["WANDB_MODE"] = "offline"
sys.path.insert(0, str(Path(__file__).parent))

from jaxtyping import install_import_hook

install_import_hook("sag", "shape_checker.checked")

import pytest
import torch

torch.set_num_threads(1)

from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19, Skeleton
from sag.types import Batch

TALLY = pytest.StashKey[Counter[str]]()
"""What tests have counted, for a line at the end (`make chaos`)."""


def pytest_configure(config: pytest.Config) -> None:
    config.stash[TALLY] = Counter()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Prints what was counted, where tests run in one process."""
    for what, count in sorted(config.stash[TALLY].items()):
        terminalreporter.line(f"{count:5} {what}")


@pytest.fixture
def tally(pytestconfig: pytest.Config) -> Counter[str]:
    """Counts what a test has done, by what it is, for the end of the output."""
    return pytestconfig.stash[TALLY]


@pytest.fixture(autouse=True)
def _seeded() -> Iterator[None]:
    """The same start for every test, and no denormals flushed in one because another measured something."""
    torch.manual_seed(0)
    yield
    torch.set_flush_denormal(False)


@pytest.fixture
def skeleton() -> Skeleton:
    return GTA_IM_19


@pytest.fixture(scope="session")
def toy_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for toy caches that is shared by the whole session."""
    return tmp_path_factory.mktemp("toy")


@pytest.fixture
def toy(toy_cache: Path):
    """The toy data module, built."""
    from toy_data import ToyDataModule

    module = ToyDataModule(toy_cache)
    module.build()
    return module


@pytest.fixture
def batch(toy) -> Batch:
    """Four windows of toy data with their clouds."""
    return next(iter(toy.test_dataloader()))


@pytest.fixture
def scale(toy) -> MotionScale:
    """Units of the toy data."""
    fitted = MotionScale(19, GTA_IM_19.root_index)
    fitted.fit(toy.training_motion)
    return fitted
