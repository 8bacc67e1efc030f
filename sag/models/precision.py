"""Which part of a run may have less precision than its tensors, where Lightning's precision flag asks for it."""

from __future__ import annotations

import torch
from torch import Tensor


def full_precision(like: Tensor) -> torch.autocast:
    """A context in which everything has the precision of its tensors, whatever `--trainer.precision` says.

    The scene encoder alone runs outside of it. It is most of a step's arithmetic and twice as fast in bfloat16;
    a gradient penalty in bfloat16 has gradients that are wrong by a third and gains little, and a trajectory that is
    summed up over 64 frames in it drifts.

    Args:
        like: a tensor on the device in question.
    """
    return torch.autocast(like.device.type, enabled=False)
