"""`sag study make | serve | files | report`: the paper's user study (Table 5)."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

from sag.options import add_cache_dir
from sag.shipped import run_path

DESCRIPTION = """\
The user study of the paper's Table 5: people score motions from 1 to 5 for how they fit the scene, and for how the
body fits the way it goes, without knowing which method made them.

  make    draws motions of runs for the same scenes and makes a page of them and the recorded motion
  serve   shows the page and collects the answers
  files   writes a page for each rater that needs no server, and whose answers come back as a file
  report  means, intervals and agreement, the paper's figures beside them"""

PAPER_RUNS = Path("runs/ablation")
"""Where `make ablation` leaves the rows that the paper's study compares."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag study`."""
    made = argparse.ArgumentParser(
        prog="sag study", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = made.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add in (_make, _serve, _files, _report):
        add(commands)
    return made


def _make(commands: argparse._SubParsersAction) -> None:
    made = commands.add_parser(
        "make", help="draw motions and make the page", description="Draws motions of runs and makes a study of them."
    )
    made.add_argument(
        "sources", type=run_path, nargs="*", metavar="RUN", default=[PAPER_RUNS],
        help="folder of a trained run, a .npz of motions, or the folder of a sweep, which stands for its rows none "
        f"(CSGN), md and mdpc as in the paper (default: {PAPER_RUNS})",
    )  # fmt: skip
    made.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the study, a new one")
    made.add_argument("--windows", type=int, default=20, metavar="N", help="scenes, evenly spread (default: 20)")
    made.add_argument("--rounds", type=int, metavar="R", help="motions of each scene a rater sees (default: all)")
    made.add_argument(
        "--repeats", type=int, metavar="K", help="motions that come twice, to see how constant a rater is (default: 4)"
    )
    made.add_argument("--seed", type=int, default=0, metavar="S", help="of the motions that are drawn (default: 0)")
    made.add_argument("--title", default="How do these motions look?", metavar="TEXT", help="of the page")
    made.add_argument(
        "--note", type=Path, metavar="FILE", help="plain text that raters read first: who asks, what for, consent"
    )
    made.add_argument("--reference", metavar="DATA", help="data set of files of motions, as for sag view")
    add_cache_dir(made)


def _serve(commands: argparse._SubParsersAction) -> None:
    made = commands.add_parser(
        "serve", help="show the page and collect answers",
        description="Serves a study until it is stopped (Ctrl-C); started again, every rater goes on.",
    )  # fmt: skip
    made.add_argument("study", type=Path, metavar="DIR", help="folder that sag study make wrote")
    made.add_argument(
        "--host", default="127.0.0.1", metavar="ADDRESS",
        help="which addresses are listened on (default: 127.0.0.1, this machine alone; 0.0.0.0 for all)",
    )  # fmt: skip
    made.add_argument("--port", type=int, default=8765, metavar="P", help="0 takes a free one (default: 8765)")


def _files(commands: argparse._SubParsersAction) -> None:
    made = commands.add_parser(
        "files", help="pages without a server",
        description="Enrols raters and writes an HTML file for each, from which answers come back as a file.",
    )  # fmt: skip
    made.add_argument("study", type=Path, metavar="DIR", help="folder that sag study make wrote")
    made.add_argument("--raters", type=int, required=True, metavar="N", help="how many files")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder of the files (default: DIR/files)")


def _report(commands: argparse._SubParsersAction) -> None:
    made = commands.add_parser(
        "report", help="what the answers say",
        description="Table 5 of the answers so far: table.md, .csv, .tex, .html, plot.png, plot.svg and answers.csv.",
    )  # fmt: skip
    made.add_argument("study", type=Path, metavar="DIR", help="folder that sag study make wrote")
    made.add_argument("returned", type=Path, nargs="*", metavar="ANSWERS.json", help="files that raters sent back")
    made.add_argument("--without", nargs="+", default=[], metavar="RATER", help="raters whose answers are left out")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder for the report (default: DIR/report)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one of the commands and returns the exit status 0.

    Raises:
        SagError: the study, a run, a file or an option is refused; the sentence names it.
    """
    asked = parser().parse_args(arguments)
    return _command(asked.command)(asked)


def _command(name: str) -> Callable[[argparse.Namespace], int]:
    """The command, loaded alone: only `make` wants networks, and a server must be there at once."""
    if name == "make":
        from sag.study.making import make as command
    elif name == "serve":
        from sag.study.serving import serve as command
    elif name == "files":
        from sag.study.serving import hand_out as command
    else:
        from sag.study.reporting import report as command
    return command
