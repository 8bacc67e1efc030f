"""`sag study report`: Table 5 of what was answered, the paper's cells beside it."""

import csv
import io
import json
import random

import pytest
from study_toys import inlined, toy_study

from sag.cli import main
from sag.report.paper import TABLE_5
from sag.study.answers import Answer
from sag.study.folder import TRUTH
from sag.study.handouts import write_handouts
from sag.study.store import Store

LIKED = {"none": 2, "md": 3, "mdpc": 4, TRUTH: 5}
"""What made-up raters think of methods."""


def scores_of(study, item: str, chance: random.Random) -> dict:
    liked = LIKED[study.settings.methods[study.items[item].method]]
    return {"scene": liked, "human": max(1, liked - chance.randint(0, 1))}


@pytest.fixture
def answered(study):
    """The study with three raters who have answered all, and one who has begun."""
    store, chance = Store(study.answers), random.Random(0)
    for place in range(4):
        rater = store.enrol("server")
        for turn, item in list(enumerate(study.session(rater.number)))[: 5 if place == 3 else None]:
            store.save(Answer(rater.name, turn, item, scores_of(study, item, chance), 6.0, 1))
    store.close()
    return study


def told(study, *options: str) -> str:
    """The report as Markdown."""
    assert main(["study", "report", str(study.folder), *options]) == 0
    return (study.folder / "report/table.md").read_text()


def test_table_5_with_the_papers_cells_beside(answered, capsys):
    text = told(answered)
    line = next(line for line in text.splitlines() if line.startswith("| mdpc"))
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert (
        cells[:4] == ["mdpc (CSGN+M+G)", "**4.00 (0.00)**", "[4.00, 4.00]", "3.56 (0.72)"] and cells[6] == "3.53 (0.68)"
    )
    assert next(line for line in text.splitlines() if line.startswith("| ground truth")).count("4.51 (0.49)") == 1
    assert "+1.00 [+1.00, +1.00]" in text and "Krippendorff" in text
    assert "1 of 4 raters have not answered everything" in text
    said = capsys.readouterr().out
    assert "User study on rooms" in said and "mdpc (CSGN+M+G)" in said
    names = {path.name for path in (answered.folder / "report").iterdir()}
    assert names == {"table.md", "table.csv", "table.tex", "table.html", "plot.png", "plot.svg", "answers.csv"}


def test_the_spreadsheets_hold_every_figure_and_every_answer(answered):
    told(answered)
    rows = list(csv.DictReader(io.StringIO((answered.folder / "report/table.csv").read_text())))
    assert [row["method"] for row in rows[::2]] == ["none", "md", "mdpc", TRUTH]
    assert float(rows[2]["mean"]) == 3 and float(rows[2]["paper_mean"]) == TABLE_5["gta_im"]["md"].scene[0]
    given = list(csv.DictReader(io.StringIO((answered.folder / "report/answers.csv").read_text())))
    assert len(given) == 3 * 14 + 5 and sum(int(row["again"]) for row in given) == 6
    assert all(int(row["scene"]) == LIKED[row["method"]] for row in given)
    assert {int(row["window"]) for row in given} == set(answered.settings.windows)
    # A motion that comes again is not counted twice.
    assert sum(int(row["answers"]) for row in rows[::2]) == len(given) - 6


def test_files_that_came_back_are_added(answered, tmp_path):
    store = Store(answered.answers)
    (path,) = write_handouts(answered, store, 1, tmp_path / "files")
    session = inlined(path.read_text(), "session")
    answers = [
        {"turn": turn, "scores": scores_of(answered, item, random.Random(1)), "seconds": 5, "plays": 1}
        for turn, _, item in session["turns"]
    ]
    file = tmp_path / "answers-1.json"
    file.write_text(json.dumps({"study": answered.name, "rater": session["rater"], "answers": answers}))
    assert "61 by 5 raters" in told(answered, str(file)) and "47 by 4 raters" in told(answered)


def test_raters_may_be_left_out(answered):
    names = list(Store(answered.answers).raters())
    text = told(answered, "--without", names[3])
    assert "42 by 3 raters" in text and f"left out by --without: {names[3]}" in text and "not answered" not in text


def test_one_rater_is_no_interval(study):
    store = Store(study.answers)
    rater = store.enrol("server")
    store.save(Answer(rater.name, 0, study.session(0)[0], {"scene": 4, "human": 4}, 6.0, 1))
    assert "one rater gives no interval" in told(study)


def test_methods_that_the_paper_has_not_stand_without_its_cells(tmp_path):
    study = toy_study(tmp_path / "s", methods=("ours", "md-s1"), repeats=0, data="prox")
    store = Store(study.answers)
    for _ in range(2):
        rater = store.enrol("server")
        for turn, item in enumerate(study.session(rater.number)):
            store.save(Answer(rater.name, turn, item, {"scene": 2, "human": 4}, 6.0, 1))
    text = told(study)
    ours, seeded = (
        next(line for line in text.splitlines() if line.startswith(f"| {name}")) for name in ("ours", "md-s1")
    )
    assert "(" not in ours.replace("2.00 (0.00)", "").replace("4.00 (0.00)", "") and "3.12 (0.88)" in seeded
    assert "PROX" in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["nowhere"], "nowhere holds no study"), (["STUDY", "--without", "ann"], "--without ann is no rater"),
        (["STUDY", "missing.json"], "missing.json is no file of answers"), (["EMPTY"], "has no answers yet"),
    ],
)  # fmt: skip
def test_refuses(answered, tmp_path, made_study, capsys, options, said):
    known = {"STUDY": str(answered.folder), "EMPTY": str(made_study)}
    assert main(["study", "report", *(known.get(option, option) for option in options)]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_answers_of_another_study_are_refused(answered, tmp_path, capsys):
    other = toy_study(tmp_path / "other")
    (other.folder / "private/answers.sqlite").write_bytes((answered.answers).read_bytes())
    assert main(["study", "report", str(other.folder)]) == 2
    assert "was not shown what answer 1 is about" in capsys.readouterr().err
