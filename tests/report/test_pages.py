"""Tables of kept results in a page: put between two marks, renewed, and nothing else touched."""

import pytest

from sag.errors import SagError
from sag.report.columns import ALONE, Column
from sag.report.pages import with_tables
from sag.report.table import Cell, Report, Table, TableRow

COLUMNS = (Column(ALONE, "row"), Column(ALONE, "many digits", detail=2), Column(ALONE, "figure"))


def report(figure: str) -> Report:
    """Two tables: the paper's, and one by name."""
    rows = (TableRow("row", (Cell("mdpc"), Cell("detail"), Cell(figure))),)
    tables = tuple(Table(title, COLUMNS, rows, "legend") for title in ("", "What each letter changes"))
    return Report("title", tables, (), ())


def page(body: str = "", title: str = "the paper's figures") -> str:
    return f"# Before\n\n<!-- table of results/one: {title} -->\n{body}<!-- end of table -->\n\nAfter | it.\n"


def test_a_table_is_put_between_the_marks_and_renewed():
    first = with_tables(page(), lambda folder: report("0.25"))
    assert "| mdpc |   0.25 |\n<!-- end of table -->\n\nAfter | it.\n" in first
    assert first.startswith("# Before\n\n<!-- table of results/one: the paper's figures -->\n| row  | figure |\n")
    assert "detail" not in first
    again = with_tables(first, lambda folder: report("0.75"))
    assert again == first.replace("0.25", "0.75")
    assert with_tables(again, lambda folder: report("0.75")) == again


def test_each_folder_is_read_once_and_tables_go_by_title():
    read = []
    text = page() + page(title="What each letter changes")
    made = with_tables(text, lambda folder: read.append(folder) or report("0.5"))  # type: ignore[func-returns-value]
    assert read == ["results/one"]
    assert made.count("| mdpc |") == 2


def test_a_page_without_marks_stays():
    assert with_tables("# Nothing\n", lambda folder: pytest.fail("read")) == "# Nothing\n"


@pytest.mark.parametrize(
    "text, problem",
    [
        (page(title="What nobody knows"), "has no table 'What nobody knows'; it has \"the paper's figures\""),
        (page().replace("<!-- end of table -->", ""), "no '<!-- end of table -->' below it"),
        ("<!-- table of results/one -->\n<!-- end of table -->\n", "has no title"),
    ],
)
def test_wrong_marks_are_refused(text, problem):
    with pytest.raises(SagError, match=problem.replace("(", r"\(")):
        with_tables(text, lambda folder: report("0.5"))
