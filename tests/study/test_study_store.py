"""The file of answers: each once, durable, never half."""

import sqlite3
import threading

import pytest

from sag.errors import SagError
from sag.study.answers import Answer, Duplicate
from sag.study.store import Store


@pytest.fixture
def path(tmp_path):
    return tmp_path / "answers.sqlite"


def said(rater: str, turn: int, scene: int = 4) -> Answer:
    return Answer(rater, turn, f"item {turn}", {"scene": scene, "human": 2}, 3.5, 1)


def test_answers_are_there_when_it_is_opened_again(path):
    store = Store(path)
    ann, bob = store.enrol("server"), store.enrol("file")
    assert (ann.number, bob.number) == (0, 1) and ann.name != bob.name
    assert [store.save(said(ann.name, turn)) for turn in (0, 2)] == [1, 2]
    # Without closing it, as after a crash.
    again = Store(path)
    assert again.answers() == [said(ann.name, 0), said(ann.name, 2)]
    assert again.answered(ann.name) == [0, 2] and again.answered(bob.name) == []
    assert again.rater(bob.name) == bob and again.rater("carl") is None and list(again.raters()) == [ann.name, bob.name]


def test_the_first_answer_stays(path):
    store = Store(path)
    ann = store.enrol("server")
    store.save(said(ann.name, 0, scene=5))
    with pytest.raises(Duplicate):
        store.save(said(ann.name, 0, scene=1))
    assert store.answers() == [said(ann.name, 0, scene=5)]


def test_the_file_itself_refuses_what_is_no_score(path):
    store = Store(path)
    ann = store.enrol("server")
    with pytest.raises(sqlite3.IntegrityError):
        store.save(said(ann.name, 0, scene=6))
    with pytest.raises(sqlite3.IntegrityError):
        store.save(said("nobody", 0))
    assert store.answers() == []
    assert store.save(said(ann.name, 0)) == 1


def test_every_commit_is_synced(path):
    store = Store(path)
    assert store.database.execute("PRAGMA journal_mode").fetchone() == ("wal",)
    assert store.database.execute("PRAGMA synchronous").fetchone() == (2,)


def test_a_full_disk_loses_nothing_that_was_kept(path):
    store = Store(path)
    ann = store.enrol("server")
    (pages,) = store.database.execute("PRAGMA page_count").fetchone()
    store.database.execute(f"PRAGMA max_page_count={pages}")
    kept = 0
    with pytest.raises(sqlite3.OperationalError, match="full"):
        for turn in range(10_000):
            kept = store.save(said(ann.name, turn))
    assert kept > 10 and store.answered(ann.name) == list(range(kept)) == Store(path).answered(ann.name)
    store.database.execute("PRAGMA max_page_count=100000")
    assert store.save(said(ann.name, kept)) == kept + 1


def test_raters_who_begin_at_once_have_numbers_of_their_own(path):
    stores = [Store(path) for _ in range(4)]

    def enrol_ten(store: Store) -> None:
        for _ in range(10):
            store.enrol("server")

    threads = [threading.Thread(target=enrol_ten, args=(store,)) for store in stores]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [rater.number for rater in stores[0].raters().values()] == list(range(40))


def test_what_is_no_database_is_named(path):
    path.write_bytes(b"no database at all" * 100)
    with pytest.raises(SagError, match=r"answers\.sqlite cannot be opened as answers"):
        Store(path)
