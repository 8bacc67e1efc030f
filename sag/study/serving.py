"""`sag study serve` and `sag study files`: the two ways in which raters get the page."""

from __future__ import annotations

import argparse
import ipaddress
import signal
import threading
from types import FrameType

from sag.errors import SagError
from sag.files import writing_in
from sag.study.folder import read_study
from sag.study.handouts import write_handouts
from sag.study.server import StudyServer
from sag.study.sessions import page_for
from sag.study.store import Store
from sag.text import plain

MOST_FILES = 1000


def serve(asked: argparse.Namespace) -> int:
    """Serves the study until it is asked to end; returns the exit status 0.

    Raises:
        SagError: there is no study, its files are damaged, or the address cannot be listened on.
    """
    study = read_study(asked.study)
    page_for(study, None)  # damaged files are found now, not by the first rater
    store = Store(study.answers)
    try:
        server = StudyServer(study, store, (asked.host, asked.port))
    except (OSError, OverflowError) as error:
        raise SagError(
            f"--host {asked.host} --port {asked.port} cannot be listened on ({error}); take another port, or 0 for a "
            "free one"
        ) from error
    print(f"{plain(study.settings.title)}: {study.design.turns} motions for each rater")
    print(f"the study is at http://{_shown(asked.host)}:{server.server_address[1]}/ (Ctrl-C ends; all answers stay)")
    if not _is_loopback(asked.host):
        print(
            "! anybody who reaches this address can take part, and what they send is not encrypted: see docs/study.md"
        )
    print(_count(store), flush=True)
    _serve_until_asked(server)
    print(_count(store))
    store.close()
    return 0


def _serve_until_asked(server: StudyServer) -> None:
    def end(number: int, frame: FrameType | None) -> None:
        threading.Thread(target=server.shutdown, daemon=True).start()  # it waits for the loop that is interrupted here

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        server.serve_forever(poll_interval=0.2)
    finally:
        server.server_close()
        for number, handler in before.items():
            signal.signal(number, handler)


def _count(store: Store) -> str:
    """How many have answered how much."""
    answers = store.answers()
    return f"{len({answer.rater for answer in answers})} raters have given {len(answers):,} answers so far"


def _shown(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def hand_out(asked: argparse.Namespace) -> int:
    """Writes a page for each of some new raters; returns the exit status 0.

    Raises:
        SagError: there is no study, or the number of raters is out of range.
    """
    if not 1 <= asked.raters <= MOST_FILES:
        raise SagError(f"--raters is {asked.raters}; write 1 to {MOST_FILES} files at a time")
    study = read_study(asked.study)
    folder = asked.out or asked.study / "files"
    store = Store(study.answers)
    with writing_in(folder, "give another folder by --out"):
        paths = write_handouts(study, store, asked.raters, folder)
    store.close()
    size = paths[0].stat().st_size / 1e6
    files = "1 file is" if len(paths) == 1 else f"{len(paths)} files are"
    print(f"{files} in {plain(str(folder))} ({size:.1f} MB each): one for each rater, sent by itself")
    print(f"what comes back: sag study report {plain(str(asked.study))} answers-*.json")
    return 0
