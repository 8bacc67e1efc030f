"""Answers on disk: one SQLite file, in which an answer is durable before it is acknowledged."""

from __future__ import annotations

import secrets
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from sag.errors import SagError
from sag.study.answers import Answer, Duplicate
from sag.study.folder import now
from sag.study.questions import QUESTIONS

Place = Literal["server", "file"]
"""Where a rater answers: on the served page, or in a file of the rater's own."""

PATIENCE = 30.0
"""Seconds to wait for another process that writes."""

SCHEMA = """
CREATE TABLE IF NOT EXISTS raters (
    id TEXT PRIMARY KEY, number INTEGER NOT NULL UNIQUE, place TEXT NOT NULL CHECK (place IN ('server', 'file')),
    began TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS answers (
    rater TEXT NOT NULL REFERENCES raters (id), turn INTEGER NOT NULL CHECK (turn >= 0), item TEXT NOT NULL,
    scene INTEGER NOT NULL CHECK (scene BETWEEN 1 AND 5), human INTEGER NOT NULL CHECK (human BETWEEN 1 AND 5),
    seconds REAL NOT NULL, plays INTEGER NOT NULL, received TEXT NOT NULL, PRIMARY KEY (rater, turn)
);
"""

COLUMNS = "rater, turn, item, scene, human, seconds, plays"


@dataclass(frozen=True)
class Rater:
    """Somebody who takes part.

    Attributes:
        name: by chance, so that it tells nothing.
        number: from 0, in the order in which they began; it says what the rater is shown.
        place: where the rater answers.
        began: when, as ISO 8601.
    """

    name: str
    number: int
    place: Place
    began: str


class Store:
    """The answers of a study; many threads may use one, and many processes a file.

    A write-ahead log that is synced at every commit (`synchronous=FULL`): what `save` returned from is there after
    the process is killed, and after the power fails if the disk keeps what it says it has written.

    Args:
        path: of the file, which is made where there is none.

    Raises:
        SagError: the file cannot be opened, or is no database.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.lock = path, threading.Lock()
        try:
            self.database = sqlite3.connect(path, PATIENCE, isolation_level=None, check_same_thread=False)
            self.database.execute("PRAGMA journal_mode=WAL")
            self.database.execute("PRAGMA synchronous=FULL")
            self.database.execute("PRAGMA foreign_keys=ON")
            self.database.executescript(SCHEMA)
        except sqlite3.Error as error:
            raise SagError(f"{path} cannot be opened as answers ({error}); restore it or move it away") from error

    def close(self) -> None:
        """Closes the file."""
        with self.lock:
            self.database.close()

    def enrol(self, place: Place) -> Rater:
        """A new rater with the next number."""
        with self._writing() as database:
            (number,) = database.execute("SELECT coalesce(max(number) + 1, 0) FROM raters").fetchone()
            rater = Rater(secrets.token_hex(6), number, place, now())
            database.execute("INSERT INTO raters VALUES (?, ?, ?, ?)", (rater.name, number, place, rater.began))
        return rater

    def raters(self) -> dict[str, Rater]:
        """All raters by name, in order of their numbers."""
        with self.lock:
            found = self.database.execute("SELECT id, number, place, began FROM raters ORDER BY number").fetchall()
        return {rater[0]: Rater(*rater) for rater in found}

    def rater(self, name: str) -> Rater | None:
        """The rater of this name, if there is one."""
        query = "SELECT id, number, place, began FROM raters WHERE id = ?"
        with self.lock:
            found = self.database.execute(query, (name,)).fetchone()
        return Rater(*found) if found else None

    def save(self, answer: Answer) -> int:
        """Keeps an answer for good; returns how many the rater has given.

        Raises:
            Duplicate: this rater has answered this turn before; the first answer stays.
        """
        values = (answer.rater, answer.turn, answer.item, *(answer.scores[one.name] for one in QUESTIONS))
        with self._writing() as database:
            known = "SELECT 1 FROM answers WHERE rater = ? AND turn = ?"
            if database.execute(known, (answer.rater, answer.turn)).fetchone():
                raise Duplicate("this motion has been answered already, and the first answer stays")
            database.execute(
                f"INSERT INTO answers ({COLUMNS}, received) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (*values, answer.seconds, answer.plays, now()),
            )
            count = "SELECT count(*) FROM answers WHERE rater = ?"
            return database.execute(count, (answer.rater,)).fetchone()[0]

    def answered(self, rater: str) -> list[int]:
        """Turns that a rater has answered."""
        with self.lock:
            found = self.database.execute("SELECT turn FROM answers WHERE rater = ? ORDER BY turn", (rater,)).fetchall()
        return [turn for (turn,) in found]

    def answers(self) -> list[Answer]:
        """All answers, by rater and turn."""
        query = f"SELECT {COLUMNS} FROM answers JOIN raters ON rater = id ORDER BY number, turn"
        with self.lock:
            found = self.database.execute(query).fetchall()
        names = [question.name for question in QUESTIONS]
        return [Answer(row[0], row[1], row[2], dict(zip(names, row[3:5])), row[5], row[6]) for row in found]

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        """One transaction, alone from its first read to its commit."""
        with self.lock:
            self.database.execute("BEGIN IMMEDIATE")
            try:
                yield self.database
                self.database.execute("COMMIT")
            except BaseException:
                if self.database.in_transaction:
                    self.database.execute("ROLLBACK")
                raise
