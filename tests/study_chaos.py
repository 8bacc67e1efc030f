"""Kills the server of a study again and again while raters answer: what it has acknowledged must be there.

`make study-chaos` runs the long form and prints the counts; `tests/study/test_study_crowd.py` runs a short one.
"""

from __future__ import annotations

import argparse
import http.client
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

from study_toys import Client, toy_study

from sag.study.folder import Study
from sag.study.store import Store

ROOT = Path(__file__).resolve().parent.parent

UNREACHED = (OSError, http.client.HTTPException)
"""What a rater meets while the server is down."""


class Served:
    """The server as a user starts it, in a process of its own.

    Args:
        study: that it serves.
    """

    def __init__(self, study: Study) -> None:
        self.study, self.port = study, 0
        self.start()

    def start(self) -> None:
        """Starts it, on the same port as before, and waits until it says where it is."""
        command = [sys.executable, "-m", "sag", "study", "serve", str(self.study.folder), "--port", str(self.port)]
        self.process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        told = [self.process.stdout.readline() for _ in range(2)]
        self.port = int(told[1].partition("http://127.0.0.1:")[2].partition("/")[0])

    def kill(self) -> None:
        """Ends it without a word of warning."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.process.stdout.close()

    def end(self) -> int:
        """Asks it to end; returns its status."""
        self.process.terminate()
        self.process.communicate(timeout=20)
        return self.process.returncode


class Answering(threading.Thread):
    """A rater who answers everything, and tries again whenever the server is away.

    Args:
        served: the server, which may be another one from one moment to the next.
        seed: of the scores.
        pace: seconds between answers, at most.
    """

    def __init__(self, served: Served, seed: int, pace: float) -> None:
        super().__init__(daemon=True)
        self.client, self.chance, self.pace = Client(served.port), random.Random(seed), pace
        self.given: dict[int, tuple[int, int]] = {}
        self.acknowledged: dict[int, tuple[int, int]] = {}
        self.counts: Counter[str] = Counter()

    def run(self) -> None:
        """Begins, answers every turn, and notes what the server acknowledged."""
        self._insist(self.client.begin)
        turns = self._insist(lambda: self.client.session)["turns"]
        for turn, (token, *_) in enumerate(turns):
            time.sleep(self.chance.uniform(0, self.pace))
            scores = self.given[turn] = (self.chance.randint(1, 5), self.chance.randint(1, 5))
            status, said = self._insist(lambda token=token, scores=scores: self.client.answer(token, *scores))
            assert status in (201, 409), said
            self.counts["acknowledged" if status == 201 else "found already there, its acknowledgement lost"] += 1
            if status == 201:
                self.acknowledged[turn] = scores

    def _insist(self, ask):
        while True:
            try:
                return ask()
            except UNREACHED:
                self.counts["tries that met no server"] += 1
                time.sleep(0.05)


def disturbed(folder: Path, kills: int, raters: int, seed: int) -> tuple[Counter[str], list[str]]:
    """Kills the server so many times at random moments while raters answer.

    Returns:
        What happened how often, and what was lost or wrong.
    """
    chance = random.Random(seed)
    study = toy_study(folder / "study", scenes=10)
    served = Served(study)
    # As fast as it takes for the last kill to come before the last answer.
    answering = [Answering(served, seed + place, pace=0.05 * kills) for place in range(raters)]
    for rater in answering:
        rater.start()
    counts: Counter[str] = Counter()
    for _ in range(kills):
        time.sleep(chance.uniform(0.05, 1.0))
        counts["kills while raters answered"] += any(rater.is_alive() for rater in answering)
        served.kill()
        served.start()
    for rater in answering:
        rater.join(300)
    counts["servers that ended in order"] = int(served.end() == 0)
    for rater in answering:
        counts += rater.counts
    return counts, lost(study, answering, counts)


def lost(study: Study, answering: list[Answering], counts: Counter[str]) -> list[str]:
    """What is not in the file as it was acknowledged, or is there otherwise than it was given."""
    store = Store(study.answers)
    assert store.database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    found = {(one.rater, one.turn): (one.scores["scene"], one.scores["human"]) for one in store.answers()}
    counts["answers in the file"] = len(found)
    wrong = []
    for rater in answering:
        name = rater.client.rater.partition(".")[0]
        wrong += [f"{name} has not ended"] if rater.is_alive() else []
        wrong += [f"lost: {name} {turn}" for turn in rater.acknowledged if (name, turn) not in found]
        wrong += [
            f"not given: {name} {turn}" for turn, scores in rater.given.items() if found.get((name, turn)) != scores
        ]
    if len(found) != study.design.turns * len(answering):
        wrong.append(f"{len(found)} answers of {study.design.turns * len(answering)}")
    return wrong


def main() -> int:
    """Runs the long form and prints the counts; 1 when anything was lost."""
    parser = argparse.ArgumentParser(prog="make study-chaos", description=__doc__)
    parser.add_argument("--kills", type=int, default=20, help="kill -9 of the server")
    parser.add_argument("--raters", type=int, default=12, help="who answer at the same time")
    parser.add_argument("--seed", type=int, default=0, help="of the moments and scores")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sag-study-") as place:
        counts, wrong = disturbed(Path(place), asked.kills, asked.raters, asked.seed)
    print("\n".join(f"{count:6} {what}" for what, count in sorted(counts.items())))
    print(f"{len(wrong):6} lost or wrong" + "".join(f"\n       {one}" for one in wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    raise SystemExit(main())
