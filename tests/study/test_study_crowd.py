"""Many raters at once, and a server that is killed while they answer: nothing acknowledged is lost."""

import threading
from collections import Counter

from study_chaos import disturbed
from study_toys import Client, served, toy_study

from sag.study.store import Store

RATERS = 50


def test_fifty_raters_answer_at_once(tmp_path):
    study = toy_study(tmp_path / "study", scenes=2, repeats=0)
    given, failures, gate = {}, [], threading.Barrier(RATERS)

    def rate(place: int, port: int) -> None:
        try:
            gate.wait(30)  # all of them in the same moment
            rater = Client(port).begin()
            for turn, (token, *_) in enumerate(rater.session["turns"]):
                scores = ((place + turn) % 5 + 1, (place * turn) % 5 + 1)
                status, said = rater.answer(token, *scores)
                assert status == 201, said
                given[rater.rater.partition(".")[0], turn] = scores
        except BaseException as error:
            failures.append(error)

    with served(study) as server:
        threads = [threading.Thread(target=rate, args=(place, server.server_address[1])) for place in range(RATERS)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(120)
    assert failures == []
    store = Store(study.answers)
    found = {(one.rater, one.turn): (one.scores["scene"], one.scores["human"]) for one in store.answers()}
    assert found == given and len(found) == RATERS * study.design.turns
    assert [rater.number for rater in store.raters().values()] == list(range(RATERS))
    firsts = Counter(study.session(number)[0] for number in range(RATERS))
    assert len(firsts) > 4  # they were not all shown the same


def test_a_killed_server_loses_nothing_that_it_acknowledged(tmp_path):
    counts, wrong = disturbed(tmp_path, kills=3, raters=4, seed=1)
    assert wrong == []
    assert counts["kills while raters answered"] == 3 and counts["servers that ended in order"] == 1
    assert counts["tries that met no server"] > 0 and counts["answers in the file"] == 4 * 42
