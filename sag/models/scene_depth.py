"""Which depth the context critic sees, and whether f is supervised by it (D)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from jaxtyping import Float
from torch import Tensor, nn

from sag.models.scene_encoder import DepthDecoder
from sag.types import DepthMap, Scene

ContextDepth = Literal["decoded", "given"]


class SceneDepth(nn.Module):
    """D off: no decoder and no loss; the depth that came with the picture is what critics see."""

    def forward(self, feature: Float[Tensor, "b f"], scene: Scene) -> tuple[DepthMap, dict[str, Tensor]]:
        """Depth for the critics, detached, and the losses of the scene encoder by name."""
        return DepthMap(scene.depth, scene.intrinsics), {}

    def decoded(self, feature: Float[Tensor, "b f"]) -> Float[Tensor, "b h w"] | None:
        """Depth (metres) that is read off f, if any is."""
        return None


class SupervisedDepth(SceneDepth):
    """D on: depth is decoded from f and held against the data's (paper, 3.1).

    Args:
        decoder: from f to depth.
        loss: predicted and true depth (metres, 0 unknown) to a scalar.
        context_depth: what critics see; `decoded` is the paper's, `given` the data's own, which helps
            while the decoder is still poor.
    """

    def __init__(
        self,
        decoder: DepthDecoder,
        loss: Callable[[Tensor, Tensor], Tensor],
        context_depth: ContextDepth = "decoded",
    ) -> None:
        super().__init__()
        self.decoder = decoder
        self.loss = loss
        self.context_depth = context_depth

    def forward(self, feature: Float[Tensor, "b f"], scene: Scene) -> tuple[DepthMap, dict[str, Tensor]]:
        """Decodes, and charges the error."""
        predicted = self.decoder(feature)
        seen = predicted.detach() if self.context_depth == "decoded" else scene.depth
        return DepthMap(seen, scene.intrinsics), {"depth": self.loss(predicted, scene.depth)}

    def decoded(self, feature: Float[Tensor, "b f"]) -> Float[Tensor, "b h w"]:
        """Depth (metres) that is read off f."""
        return self.decoder(feature)
