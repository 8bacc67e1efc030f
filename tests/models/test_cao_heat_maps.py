import pytest
import torch

from sag.models.cao.heat_maps import CELL, cell_centres, heat_maps, map_size, peak, spread


@pytest.mark.parametrize("picture", [(36, 64), (72, 128), (256, 448), (288, 512)])
def test_a_place_is_found_again(picture: tuple[int, int]) -> None:
    size = torch.tensor([picture[1], picture[0]])
    pixels = (0.1 + 0.8 * torch.rand(20, 2)) * size
    maps = heat_maps(pixels[:, None], map_size(*picture))
    assert torch.allclose(peak(maps[:, 0]), pixels, atol=0.02)


def test_usual_sizes() -> None:
    assert map_size(256, 448) == (64, 112)
    assert spread(64) == 2
    assert spread(18) == 1


def test_odd_pictures_have_maps_that_cover_them() -> None:
    rows, columns = map_size(37, 66)
    assert (rows, columns) == (10, 17)
    centres = cell_centres((rows, columns), torch.zeros(()))
    assert centres[0, 0].tolist() == [CELL / 2, CELL / 2]


def test_a_bump_is_1_at_its_place_and_moves_with_it() -> None:
    size = map_size(72, 128)
    places = torch.tensor([[[30.0, 34.0], [34.0, 34.0]]])
    maps = heat_maps(places, size)[0]
    assert maps.amax(dim=(1, 2)).tolist() == [1.0, 1.0]
    assert torch.allclose(maps[0, :, :-1], maps[1, :, 1:])


def test_a_place_outside_leaves_nothing() -> None:
    assert heat_maps(torch.tensor([[[-100.0, 20.0]]]), (18, 32)).max() < 1e-6


@pytest.mark.parametrize("corner", [(0.0, 0.0), (127.9, 71.9)])
def test_a_peak_at_the_edge_is_in_the_picture(corner: tuple[float, float]) -> None:
    found = peak(heat_maps(torch.tensor([[corner]]), (18, 32))[:, 0])
    assert ((found >= 0) & (found <= torch.tensor([128.0, 72.0]))).all()
    assert (found - torch.tensor([corner])).norm() <= CELL


def test_empty_and_negative_maps_have_a_peak_too() -> None:
    assert peak(torch.zeros(1, 18, 32)).isfinite().all()
    assert peak(-torch.rand(1, 18, 32)).isfinite().all()
