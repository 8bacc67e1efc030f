"""What a scene encoder starts from: random weights, ImageNet's, or those of another run's encoder."""

from __future__ import annotations

from sag.methods.pretrained import AVERAGED, SAMPLER, read_checkpoint
from sag.methods.weights import check_shapes
from sag.models.scene_encoder import BlindEncoder, SceneEncoder

OPTION = "network.scene_encoder"


def start_encoder(encoder: SceneEncoder | BlindEncoder) -> str:
    """Loads the file in which an encoder starts, if there is one; returns what it starts from, in words.

    Of another run it is the encoder that samples: the average, where one is kept.

    Raises:
        SagError: the file is missing, damaged or for an encoder of other sizes.
    """
    if isinstance(encoder, BlindEncoder):
        return "nothing: it does not look"
    start = encoder.start
    if start.imagenet is not None:
        encoder.resnet.load_imagenet(start.imagenet)
        return str(start.imagenet)
    if start.checkpoint is None:
        return "random weights, not from ImageNet"
    state = read_checkpoint(OPTION, start.checkpoint)["state_dict"]
    sampler = AVERAGED if any(name.startswith(AVERAGED) for name in state) else SAMPLER
    prefix = f"{sampler}encoder."
    found = {name.removeprefix(prefix): value for name, value in state.items() if name.startswith(prefix)}
    fix = "train it with the same width, feature_grid and feature_norm"
    check_shapes(f"the scene encoder of {OPTION} {start.checkpoint} does not fit", found, encoder.state_dict(), fix)
    encoder.load_state_dict(found)
    return f"the scene encoder in {start.checkpoint}"
