"""The server: sessions go on, and nothing but honest answers is taken."""

import gzip
import http.client
import json
import socket

import pytest
from study_toys import Client, inlined, served, toy_study

from sag.cli import main
from sag.study.command import parser
from sag.study.store import Store


def test_it_listens_to_this_machine_alone_unless_told_otherwise():
    assert parser().parse_args(["serve", "x"]).host == "127.0.0.1"


def test_the_page_and_its_scenes(client, study):
    status, body, headers = client.ask("GET", "/", Accept_Encoding="gzip")
    assert status == 200 and headers["Content-Encoding"] == "gzip" and headers["Cache-Control"] == "no-store"
    assert headers["Referrer-Policy"] == "no-referrer" and headers["X-Frame-Options"] == "DENY"
    page = gzip.decompress(body).decode()
    assert inlined(page, "session") is None and inlined(page, "scenes") == {}
    assert "connect-src 'self'" in page and "default-src 'none'" in page
    for name in study.scenes:
        status, plain, headers = client.ask("GET", f"/scenes/{name}")
        assert status == 200 and "immutable" in headers["Cache-Control"]
        assert gzip.decompress(client.ask("GET", f"/scenes/{name}", Accept_Encoding="gzip")[1]) == plain
        assert len(json.loads(plain)["motions"]) == 4


def test_a_session_goes_on_where_it_was(client, study):
    session = client.session
    assert len(session["turns"]) == study.design.turns == 14 and session["answered"] == []
    for done, (turn, *_) in enumerate(session["turns"][:3], 1):
        assert client.answer(turn) == (201, {"answered": done, "of": 14})
    assert client.session == {**session, "answered": [0, 1, 2]}
    assert Client(client.port).begin().session["turns"] != session["turns"]


def test_a_session_goes_on_after_the_server_was_started_again(study):
    with served(study) as server:
        rater = Client(server.server_address[1]).begin()
        rater.answer(rater.session["turns"][0][0])
    with served(study) as server:
        rater.port = server.server_address[1]
        assert rater.session["answered"] == [0]


def test_answers_are_kept_as_they_were_given(client, study):
    for place, (turn, *_) in enumerate(client.session["turns"]):
        assert client.answer(turn, place % 5 + 1, 5 - place % 5, seconds=2.25 + place, plays=place)[0] == 201
    store = Store(study.answers)
    found = store.answers()
    assert [answer.item for answer in found] == study.session(store.raters()[found[0].rater].number)
    assert [(answer.scores["scene"], answer.scores["human"]) for answer in found[:5]] == [
        (1, 5),
        (2, 4),
        (3, 3),
        (4, 2),
        (5, 1),
    ]
    assert [(answer.seconds, answer.plays) for answer in found[:2]] == [(2.25, 0), (3.25, 1)]


def test_a_second_answer_is_refused_and_the_first_stays(client, study):
    turn = client.session["turns"][0][0]
    assert client.answer(turn, 5)[0] == 201
    assert client.answer(turn, 1)[0] == client.answer(turn, 5)[0] == 409
    assert [answer.scores["scene"] for answer in Store(study.answers).answers()] == [5]


@pytest.mark.parametrize("score", [0, 6, -1, 3.5, 4.0, "4", None, True, [4], {}, 10**30, float("nan"), float("inf")])
def test_scores_out_of_range_are_refused(client, study, score):
    turn = client.session["turns"][0][0]
    assert client.answer(turn, scene=score)[0] == client.answer(turn, human=score)[0] == 422
    assert Store(study.answers).answers() == [] and client.answer(turn)[0] == 201


@pytest.mark.parametrize(
    "changes",
    [
        {"scores": {"scene": 3}}, {"scores": {"scene": 3, "human": 3, "more": 3}}, {"scores": [3, 3]}, {"scores": None},
        {"seconds": -1}, {"seconds": "3"}, {"seconds": None}, {"seconds": True}, {"seconds": 1e300}, {"plays": 1.5},
        {"plays": -1}, {"plays": None},
    ],
)  # fmt: skip
def test_answers_that_are_none_are_refused(client, study, changes):
    turn = client.session["turns"][0][0]
    status, content = client.answer(turn, **changes)
    assert status == 422 and content["error"]
    assert Store(study.answers).answers() == []


def test_forged_answers_are_refused(client, study, tmp_path):
    turns = client.session["turns"]
    other = Client(client.port).begin()
    forged = toy_study(tmp_path / "forged").signer
    name = client.rater.partition(".")[0]
    wrong = [turns[0][0][:-1], turns[0][0] + "A", "0.", "", None, 7, forged.turn(name, 0, turns[0][2])]
    wrong += [token for token, *_ in other.session["turns"]]
    wrong += [f"{place}.{turns[0][0].partition('.')[2]}" for place in (1, 2, 99, -1)]
    assert {client.answer(token)[0] for token in wrong} == {403}
    longer = name + "0" + client.rater[len(name) :]
    for session in (None, "", "x", f"{name}.", forged.session(name), client.rater[:-1], longer):
        client.rater = session
        assert client.answer(turns[0][0])[0] == 403
    assert Store(study.answers).answers() == []


def test_a_session_that_nobody_began_is_refused(client, study):
    client.rater = study.signer.session("0123456789ab")  # well signed, but enrolled nowhere
    assert client.answer("0.x")[0] == 403
    status, body, headers = client.ask("GET", f"/?rater={client.rater}")
    assert status == 403 and b"open it by the link" in body and headers.get_content_type() == "text/html"


def test_a_rater_of_a_file_cannot_answer_on_the_page(client, server, study):
    rater = server.store.enrol("file")
    client.rater = study.signer.session(rater.name)
    assert client.answer(study.signer.turn(rater.name, 0, study.session(rater.number)[0]))[0] == 403


@pytest.mark.parametrize(
    ("path", "body", "kind", "status"),
    [
        ("/answers", b"x" * 5000, "application/json", 413), ("/answers", b"{", "application/json", 400),
        ("/answers", b"[]", "application/json", 400), ("/answers", b"\xff", "application/json", 400),
        ("/answers", b"{}", "text/plain", 415), ("/raters", b"{}", "application/x-www-form-urlencoded", 415),
        ("/answers", b"{}", "application/json", 403), ("/", b"{}", "application/json", 404),
        ("/answers", b"[" * 4000, "application/json", 400),
    ],
)  # fmt: skip
def test_other_requests_are_refused(client, path, body, kind, status):
    assert client.ask("POST", path, body, Content_Type=kind)[0] == status


def test_a_request_must_tell_its_length(client):
    with socket.create_connection(("127.0.0.1", client.port)) as line:
        line.sendall(b"POST /answers HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n")
        assert line.recv(100).startswith(b"HTTP/1.1 413")


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "HEAD"])
def test_other_methods_are_unknown(client, method):
    assert client.ask(method, "/")[0] == 501


def test_a_connection_serves_many_requests(client):
    line = http.client.HTTPConnection("127.0.0.1", client.port)
    for turn, *_ in client.session["turns"][:4]:
        content = {"rater": client.rater, "turn": turn, "scores": {"scene": 1, "human": 5}, "seconds": 1, "plays": 1}
        line.request("POST", "/answers", json.dumps(content), {"Content-Type": "application/json"})
        assert line.getresponse().read() and line.sock is not None


def test_what_cannot_be_saved_is_not_acknowledged(client, server, study, capsys):
    turns = client.session["turns"]
    refusing = "CREATE TEMP TRIGGER full BEFORE INSERT ON main.answers BEGIN SELECT RAISE(FAIL, 'full'); END"
    server.store.database.execute(refusing)
    status, content = client.answer(turns[0][0])
    assert status == 503 and "tries again" in content["error"] and "could not be saved" in capsys.readouterr().err
    server.store.database.execute("DROP TRIGGER full")
    assert client.answer(turns[0][0])[0] == 201


def test_a_study_that_is_damaged_says_so(client, study):
    (study.public / "page.html").unlink()
    assert client.ask("GET", "/")[0] == 500


def test_a_port_that_is_taken_is_named(client, study, capsys):
    assert main(["study", "serve", str(study.folder), "--port", str(client.port)]) == 2
    error = capsys.readouterr().err
    assert f"--port {client.port} cannot be listened on" in error and error.count("\n") == 1
