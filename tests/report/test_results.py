import math

import pytest

from sag.errors import SagError
from sag.report.lines import Figure, lines_of, twin_ratios
from sag.report.results import check_comparable, read_results


def test_lines_stand_in_the_order_in_which_they_are_read(whole):
    whole.add("hp_gan", method="HPGAN", components=None)
    names = [line.name for line in lines_of(read_results(whole.folder))]
    assert names == [
        "none", "d", "p", "c", "dp", "dc", "pc", "dpc",
        "m", "md", "mp", "mc", "mdp", "mdc", "mpc", "mdpc",
        "hp_gan", "ground_truth",
    ]  # fmt: skip


def test_seeds_of_a_row_are_one_line(runs):
    for seed, fid in enumerate((10.0, 14.0, 18.0)):
        runs.add(f"mdp-s{seed}", fid, seed=seed)
    (line,) = lines_of(read_results(runs.folder))
    assert line.name == line.paper_row == "mdp"
    assert line.figures["motion_fid/average"] == Figure(14.0, 4.0, 3)


def test_one_seed_with_nan_makes_the_figure_nan(runs):
    runs.add("m-s0", 10.0)
    runs.add("m-s1", math.nan, seed=1)
    (line,) = lines_of(read_results(runs.folder))
    assert math.isnan(line.figures["motion_fid/average"].mean)


def test_a_variant_of_a_row_is_a_line_of_its_own_and_not_the_papers(runs):
    runs.add("mdp")
    runs.add("mdp-critic_steps=3")
    lines = lines_of(read_results(runs.folder))
    assert [line.paper_row for line in lines] == ["mdp", "mdp-critic_steps=3"]


def test_twin_ratios_divide_the_row_without_m_by_the_one_with_it(runs):
    for row, fid in {"none": 100.0, "m": 20.0, "d": 30.0, "md": 60.0, "p": 5.0, "mc": 7.0}.items():
        runs.add(row, fid)
    assert twin_ratios(lines_of(read_results(runs.folder))) == {"none / m": 5.0, "d / md": 0.5}


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"data": {"fingerprint": "other"}}, "data fingerprint (abcdef123456 in d; other in m)"),
        ({"data": {"fps": 25.0}}, "fps (30.0 in d; 25.0 in m)"),
        ({"data": {"name": "gta_im"}}, "data set"),
        ({"protocol": {"motions": 21}}, "N of motions"),
        ({"protocol": {"collision_frames": 21}}, "N of collision frames"),
        ({"protocol": {"encoders": "x"}}, "encoders"),
        ({"protocol": {"skeleton": "prox_16"}}, "skeleton"),
        ({"protocol": {"samples": 5}}, "samples of each window (None in d; 5 in m)"),
        ({"protocol": {"collision_shape": "cylinder"}}, "collision shape"),
    ],
)
def test_rows_that_were_measured_differently_are_refused_by_name(runs, changes, named):
    runs.add("d")
    check_comparable(read_results(runs.folder))
    runs.add("m", **changes)
    with pytest.raises(SagError) as error:
        check_comparable(read_results(runs.folder))
    assert named in str(error.value)
    assert str(error.value).count(" in m") == 1, "nothing else differs"


def test_many_rows_are_not_listed_one_by_one(whole):
    whole.add("mdpc", data={"fps": 25.0})
    with pytest.raises(SagError, match=r"30\.0 in c and 15 others; 25\.0 in mdpc"):
        check_comparable(read_results(whole.folder))


@pytest.mark.parametrize(
    ("state", "shown", "reason"),
    [
        ("failed", "failed", "ValueError"),
        ("interrupted", "interrupted", "ValueError"),
        ("finished", "failed", "metrics"),
    ],
)
def test_rows_without_figures_stay_visible(runs, state, shown, reason):
    runs.add("none")
    runs.fail("mdp-s1", state, "ValueError" if state != "finished" else None)
    _, line = lines_of(read_results(runs.folder))
    assert (line.name, line.components["projection"]) == ("mdp", True)
    assert line.unfinished[0].state == shown
    assert reason in line.unfinished[0].reason


def test_figures_of_a_row_that_failed_after_its_test_are_not_shown(runs):
    runs.add("none")
    runs.add("m")
    runs.fail("m")
    assert [result.finished for result in read_results(runs.folder)] == [False, True]


def test_finished_encoders_are_no_row(runs):
    runs.add("m")
    runs.write("encoders", "status.json", {"state": "finished"})
    assert [result.name for result in read_results(runs.folder)] == ["m"]


def test_null_is_nan(runs):
    runs.add("m", metrics={"motion_fid/average": None})
    assert math.isnan(read_results(runs.folder)[0].metrics["motion_fid/average"])


def test_a_folder_without_figures_is_refused(runs):
    with pytest.raises(SagError, match="is no folder"):
        read_results(runs.folder)
    runs.fail("m", reason="it broke")
    with pytest.raises(SagError, match=r"no finished row.*m: it broke"):
        read_results(runs.folder)


@pytest.mark.parametrize("text", ["{", "[]", '{"metrics": {}}', "null"])
def test_a_damaged_file_is_named(runs, text):
    runs.add("m")
    path = runs.folder / "m" / "metrics.json"
    path.write_text(text)
    with pytest.raises(SagError, match=str(path)):
        read_results(runs.folder)


def test_one_seed_does_not_count_twice(runs):
    runs.add("m", 10.0)
    runs.add("m-s0", 11.0)
    with pytest.raises(SagError, match="m-s0"):
        lines_of(read_results(runs.folder))
