import pytest

from sag.report import paper
from sag.report.paper import GTA_IM, PROX, paper_figures


def test_tables_of_one_data_set_agree_where_they_print_the_same_row():
    shared = set(paper.TABLE_1_MOTION_FID) & set(paper.TABLE_2)
    assert shared == {"none", "md", "mdpc"}
    assert all(paper.TABLE_1_MOTION_FID[row] == paper.TABLE_2[row] for row in shared)


@pytest.mark.parametrize("table", [paper.TABLE_1_MOTION_FID, paper.TABLE_2, paper.TABLE_3], ids=("1", "2", "3"))
def test_longer_horizons_are_harder_in_every_row(table):
    assert all(short < mid < long and short < average < long for short, mid, long, average in table.values())


@pytest.mark.parametrize("table", [paper.TABLE_1_NON_COLLISION, paper.TABLE_4], ids=("1", "4"))
def test_thicker_bodies_collide_more_in_every_row(table):
    assert all(1 > thin > middle > thick > 0 and thin > mean > thick for thin, middle, thick, mean in table.values())


def test_cells_carry_what_is_printed_and_nothing_else():
    assert GTA_IM.cells("mdpc")["motion_fid/average"] == 27.6, "not the mean of its row, 27.9"
    assert not any(name.startswith("non_collision") for name in GTA_IM.cells("none"))
    assert GTA_IM.cells("mp") == {}
    assert GTA_IM.cells("hp_gan")["motion_fid/short"] == 156.6
    assert PROX.cells("mdp") == {
        "non_collision/30": 0.813, "non_collision/45": 0.764, "non_collision/60": 0.733, "non_collision/average": 0.770,
    }  # fmt: skip


@pytest.mark.parametrize(("data", "figures"), [("rooms", GTA_IM), ("gta_im", GTA_IM), ("prox", PROX), ("PROX", PROX)])
def test_each_data_set_has_the_nearest_of_the_papers(data, figures):
    assert paper_figures(data) is figures
