"""Names of figures, as logs and reports have them."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor


def named(name: str, figures: Any) -> dict[str, Tensor]:
    """Figures under the name of their metric: `name/part`, or the name alone where there is one figure."""
    if not isinstance(figures, dict):
        return {name: torch.as_tensor(figures)}
    return {f"{name}/{part}": torch.as_tensor(figure) for part, figure in figures.items()}
