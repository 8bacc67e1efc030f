"""Counts arithmetic as it is done, in all orders of differentiation."""

from __future__ import annotations

from typing import Any

from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils.flop_counter import flop_registry

from benchmarks.paired import Work


class Flops(TorchDispatchMode):
    """Adds up torch's own formulas for products and convolutions.

    `FlopCounterMode` has the same formulas, but follows modules by hooks that refuse a gradient by a leaf, as the
    penalty has it.

    Attributes:
        total: multiplications and additions so far.
    """

    def __init__(self) -> None:
        super().__init__()
        self.total = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        """Runs an operator and counts it."""
        made = func(*args, **(kwargs or {}))
        formula = flop_registry.get(func._overloadpacket)
        if formula is not None:
            self.total += formula(*args, **(kwargs or {}), out_val=made)
        return made


def flops(work: Work) -> int:
    """Multiplications and additions of one run."""
    with Flops() as counted:
        work.run(0)
    return counted.total
