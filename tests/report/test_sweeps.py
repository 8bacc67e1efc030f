"""Several sweeps in one report."""

import shutil

import pytest

from sag.errors import SagError
from sag.report import main
from sag.report.lines import lines_of, twin_ratios
from sag.report.sweeps import read_sweeps, sweep_names


@pytest.fixture
def other(runs, tmp_path):
    """A second folder of runs."""
    return type(runs)(tmp_path / "more" / "table1")


def names(*folders):
    return [line.label for line in lines_of(read_sweeps(folders))]


def test_rows_that_no_two_sweeps_share_are_one_sweep(runs, other):
    runs.add("none", 100.0)
    other.add("m", 20.0)
    assert names(runs.folder, other.folder) == ["none", "m"]
    assert twin_ratios(lines_of(read_sweeps([runs.folder, other.folder]))) == {"none / m": 5.0}


def test_shared_names_are_told_apart_and_twins_stay_in_their_sweep(runs, other):
    runs.add("none", 100.0)
    runs.add("m-s0", 20.0)
    other.add("m-s1", 50.0, seed=1)
    assert names(runs.folder, other.folder) == ["none (ablation)", "m (ablation)", "m (table1)"]
    assert twin_ratios(lines_of(read_sweeps([runs.folder, other.folder]))) == {"none (ablation) / m (ablation)": 5.0}


def test_a_ground_truth_of_the_same_figures_is_kept_once(runs, other):
    for folder in (runs, other):
        folder.add("m")
        folder.add_truth()
    assert names(runs.folder, other.folder)[-1] == "ground_truth"
    other.add_truth(metrics={"foot_skate": 1.0})
    assert names(runs.folder, other.folder)[-2:] == ["ground_truth (ablation)", "ground_truth (table1)"]


def test_sweeps_are_called_by_as_many_folders_as_it_takes(tmp_path):
    assert sweep_names([tmp_path / "a" / "x", tmp_path / "b" / "x"]) == ["a/x", "b/x"]
    assert sweep_names([tmp_path / "x"]) == ["x"]
    with pytest.raises(SagError, match="named twice"):
        sweep_names([tmp_path / "x", tmp_path / "a" / ".." / "x"])


def test_one_report_has_the_statistics_of_each(runs, other, tmp_path):
    for row, fid in {"none": 100.0, "m": 20.0, "md": 18.0}.items():
        for seed in range(2):
            runs.add(f"{row}-s{seed}", fid + seed, seed=seed)
    shutil.copytree(runs.folder, other.folder)
    assert main([str(runs.folder), str(other.folder), "--out", str(tmp_path / "both")]) == 0
    text = (tmp_path / "both" / "table.md").read_text()
    assert "# Ablation and table1 on rooms" in text
    assert text.count("\n## Neighbouring rows") == 2 and "paired by seed (table1)" in text
    assert {path.name for path in (tmp_path / "both").glob("letters*.png")} == {
        "letters-ablation.png", "letters-table1.png",
    }  # fmt: skip


def test_sweeps_that_do_not_compare_are_refused(runs, other, tmp_path):
    runs.add("m")
    other.add("m", protocol={"encoders": "x"})
    with pytest.raises(SagError, match=r"encoders \(e5c0de in m \(ablation\); x in m \(table1\)\)"):
        main([str(runs.folder), str(other.folder), "--out", str(tmp_path / "both")])
    assert not (tmp_path / "both").exists()


def test_options_that_contradict_each_other_are_refused(runs, other, tmp_path):
    runs.add("m")
    other.add("none")
    both = [str(runs.folder), str(other.folder)]
    with pytest.raises(SagError, match="--out DIR"):
        main(both)
    with pytest.raises(SagError, match="--keep takes one folder"):
        main([*both, "--out", str(tmp_path / "x"), "--keep", str(tmp_path / "y")])
    with pytest.raises(SagError, match="--overwrite is for --keep"):
        main([both[0], "--overwrite"])
