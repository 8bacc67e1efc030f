"""The command line: `sag fit | run | validate | test | predict`, and the tools around a run."""

from __future__ import annotations

import difflib
import importlib
import io
import sys
from collections.abc import Callable

from sag.errors import INTERRUPTED, OutOfSpace, SagError
from sag.files import FULL
from sag.text import plain

TOOLS = {
    "data": "builds, checks and shows data sets",
    "score": "every figure of a test for motions from a file",
    "sweep": "runs every row of a sweep file",
    "report": "lays finished rows side by side",
    "doctor": "says whether this machine is ready, and what to do where it is not",
    "figure7": "the paper's Figure 7: how far trajectories to one end point part on the way",
    "critics": "what the critics of trained runs listen to, and how hard each pulls",
    "sample": "motions from your own photograph or a window, as files and films",
    "figure": "strips of poses over runs (the paper's Figures 1, 4, 8), contact sheets, how fast people move",
    "slim": "a trained run as small as it can be handed on",
    "extend": "samples motions of any length from a trained run",
    "export": "motions of a file as BVH, animated glTF, films and more",
    "view": "motions in their scenes as one HTML file for any browser",
    "study": "the paper's user study (Table 5): people score motions without knowing whose they are",
}
"""Subcommands that do not train, with what they do."""

PLACES = {"data": "data.command", "doctor": "doctor.command_line", "figure": "figures", "export": "exporting"}
"""Where tools lie that are not called by their module's name."""

TRAINING = ("fit", "run", "validate", "test", "predict")
"""Subcommands of the Lightning command line; `run` is fit, then test."""


def main(arguments: list[str] | None = None) -> int:
    """Runs one command; errors a user can mend are one sentence and a status that is not 0, see `sag.errors`."""
    arguments = sys.argv[1:] if arguments is None else arguments
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # no name of a file is worth a traceback
    try:
        return _dispatch(arguments)
    except SagError as error:
        return _refused(error)
    except KeyboardInterrupt:
        print("sag: interrupted", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        if error.errno not in FULL:
            raise
        where = f"{error.filename} cannot be written" if error.filename else "a file cannot be written"
        return _refused(OutOfSpace(f"{where} ({error.strerror}); make room, then the same command goes on"))


def _refused(error: SagError) -> int:
    print(f"sag: {plain(' '.join(str(error).splitlines()))}", file=sys.stderr)
    return error.status


def _dispatch(arguments: list[str]) -> int:
    name = arguments[0] if arguments else "--help"
    if name in TRAINING:
        from sag.training import train

        return train(arguments)
    if name in TOOLS:
        return _tool(name)(arguments[1:])
    if name in ("-h", "--help", "--version"):
        print(_help() if name != "--version" else _version())
        return 0
    close = difflib.get_close_matches(name, [*TRAINING, *TOOLS], 1)
    raise SagError(f"there is no command {name!r}" + (f"; did you mean {close[0]!r}?" if close else "; see sag --help"))


def _tool(name: str) -> Callable[[list[str]], int]:
    """The `main` of a tool; only the tool that is called is imported."""
    tool: Callable[[list[str]], int] = importlib.import_module(f"sag.{PLACES.get(name, name)}").main
    return tool


def _version() -> str:
    from sag import __version__

    return f"sag {__version__}"


def _help() -> str:
    lines = ["usage: sag COMMAND [options]; every command has --help", ""]
    about = {
        "fit": "trains",
        "run": "trains, then tests: what a row of a sweep is",
        "validate": "scores the held-out windows of the training rooms",
        "test": "scores a checkpoint on the test windows",
        "predict": "samples motions for the test windows into predictions.npz",
        **TOOLS,
    }
    return "\n".join(lines + [f"  {name:10} {what}" for name, what in about.items()])
