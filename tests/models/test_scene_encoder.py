import pytest
import torch

from sag.models.scene_encoder import BlindEncoder, DepthDecoder, SceneEncoder


@pytest.mark.parametrize("grid", [(1, 1), (2, 3)])
def test_feature_length(grid: tuple[int, int]) -> None:
    assert SceneEncoder(10, width=8, grid=grid)(torch.rand(2, 3, 72, 128)).shape == (2, 10)


def test_less_precision_stays_inside() -> None:
    encoder, picture = SceneEncoder(10, width=8).eval(), torch.rand(2, 3, 72, 128)
    whole = encoder(picture)
    with torch.autocast("cpu", torch.bfloat16):
        less = encoder(picture)
    assert less.dtype == torch.float32
    assert not torch.equal(less, whole) and torch.allclose(less, whole, atol=0.05)


def test_a_finer_grid_knows_where_things_are() -> None:
    picture = torch.zeros(1, 3, 64, 128)
    picture[..., :40] = 1
    encoder = SceneEncoder(10, width=8, grid=(1, 4)).eval()
    assert not torch.allclose(encoder(picture), encoder(picture.flip(-1)), atol=1e-4)


def test_a_normalised_feature_has_deviation_one_however_large_the_layer_before_it() -> None:
    encoder, pictures = SceneEncoder(10, width=8, norm="batch"), torch.rand(16, 3, 36, 64)
    encoder.fc.weight.data.mul_(1000)
    feature = encoder(pictures)
    assert torch.allclose(feature.mean(0), torch.zeros(10), atol=1e-3)
    assert torch.allclose(feature.std(0, unbiased=False), torch.ones(10), atol=1e-2)
    alone = encoder.eval()(pictures[:1])  # by running statistics, so that one picture has a feature too
    assert torch.allclose(alone, encoder(pictures)[:1], atol=1e-3)


@pytest.mark.parametrize("dtype", [torch.float32, torch.bfloat16])
def test_a_blind_encoder_says_nothing_and_learns_nothing(dtype: torch.dtype) -> None:
    encoder = BlindEncoder(10)
    feature = encoder(torch.rand(2, 3, 8, 8, dtype=dtype))
    assert feature.shape == (2, 10) and feature.dtype == dtype
    assert not feature.any() and not encoder.state_dict()


@pytest.mark.parametrize("size", [(288, 512), (72, 128), (36, 64), (50, 70)])
def test_depth_has_the_pictures_size_and_is_positive(size: tuple[int, int]) -> None:
    depth = DepthDecoder(12, size, channels=16)(torch.randn(2, 12))
    assert depth.shape == (2, *size)
    assert (depth > 0).all()


def test_the_decoder_starts_from_the_papers_ninth_and_sixteenth() -> None:
    assert DepthDecoder(4, (288, 512), channels=8).sizes == [(9, 16), (18, 32), (36, 64), (72, 128), (144, 256)]


def test_depth_comes_from_the_feature() -> None:
    feature = torch.randn(1, 12, requires_grad=True)
    DepthDecoder(12, (36, 64), channels=16).eval()(feature).sum().backward()
    assert feature.grad.abs().sum() > 0
