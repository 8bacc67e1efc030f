"""Motions and untrained encoders, which is enough for everything but the meaning of the figures."""

import numpy as np
import pytest
import torch
from torch import Tensor
from toy_data import walks

from sag.models.erd import MotionEncoders


@pytest.fixture(scope="session")
def encoders() -> MotionEncoders:
    """In float64, so that sums are exact."""
    torch.manual_seed(0)
    return MotionEncoders("gta_im_19", width=0.01).double().eval()


@pytest.fixture(scope="session")
def motions() -> Tensor:
    return torch.from_numpy(walks(48, np.random.default_rng(1))).double()


@pytest.fixture(scope="session")
def others() -> Tensor:
    return torch.from_numpy(walks(48, np.random.default_rng(2))).double()
