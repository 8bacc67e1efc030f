"""The server of a study: a page, its scenes, and answers that are on disk before they are acknowledged."""

from __future__ import annotations

import gzip
import json
import sqlite3
import sys
from functools import lru_cache
from html import escape
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from sag.errors import SagError
from sag.study.answers import Duplicate, checked_answer
from sag.study.folder import Study
from sag.study.sessions import page_for, scene_of, session_of
from sag.study.store import Rater, Store
from sag.study.tokens import Forged

MOST_BYTES = 4096
"""Of what a page may send at once."""

SCENES_KEPT = 64
"""Compressed scenes in memory."""

HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",  # the address of a page is the rater's key
    "Cross-Origin-Resource-Policy": "same-origin",
}

REFUSAL = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark"><title>Study</title><link rel="icon" href="data:,"></head>
<body><main><h1>This does not open</h1><p>{}.</p></main></body></html>
"""


class Refused(SagError):
    """A request that is answered with a status of its own.

    Args:
        status: of HTTP.
        sentence: why.
    """

    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.code = status


class StudyServer(ThreadingHTTPServer):
    """A thread for each connection; see `Handler` for what it answers.

    Args:
        study: that is served.
        store: of its answers.
        address: host and port; port 0 takes a free one.
    """

    daemon_threads = True
    request_queue_size = 256  # a class of raters may begin at the same moment

    def __init__(self, study: Study, store: Store, address: tuple[str, int]) -> None:
        self.study, self.store = study, store
        self.scene = lru_cache(SCENES_KEPT)(lambda name: gzip.compress(scene_of(study, name).encode(), 6))
        super().__init__(address, Handler)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Says nothing of connections that break, which phones do all day; everything else is told."""
        if not isinstance(sys.exc_info()[1], (ConnectionError, TimeoutError)):
            super().handle_error(request, client_address)


class Handler(BaseHTTPRequestHandler):
    """What raters may ask.

    - `GET /` the page without a session, `GET /?rater=TOKEN` a rater's own, with what is left to answer
    - `GET /scenes/NAME` a scene with its motions
    - `POST /raters` begins a session: 201 and its token
    - `POST /answers` 201 once the answer is on disk; 403 forged, 409 answered before, 422 no answer at all
    """

    server: StudyServer
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "sag", ""
    timeout = 60
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        """Answers what a browser loads."""
        self._answer(self._get)

    def do_POST(self) -> None:
        """Answers what a page sends."""
        self._answer(self._post)

    def log_message(self, format: str, *args: Any) -> None:
        """Keeps no log: addresses of raters are nobody's business."""

    def _answer(self, act: Any) -> None:
        try:
            act()
        except Refused as error:
            self._refuse(error.code, error)
        except Forged as error:
            self._refuse(HTTPStatus.FORBIDDEN, error)
        except Duplicate as error:
            self._refuse(HTTPStatus.CONFLICT, error)
        except SagError as error:
            own = self.command == "GET"  # then it is the study that is damaged, not what was sent
            self._refuse(HTTPStatus.INTERNAL_SERVER_ERROR if own else HTTPStatus.UNPROCESSABLE_ENTITY, error)
        except sqlite3.Error as error:
            print(f"sag: an answer could not be saved: {error}", file=sys.stderr, flush=True)
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, "nothing can be saved at the moment; the page tries again")

    def _get(self) -> None:
        asked = urlsplit(self.path)
        if asked.path == "/":
            token = parse_qs(asked.query).get("rater", [None])[-1]
            session = None if token is None else self._session(token)
            self._send(HTTPStatus.OK, page_for(self.server.study, session).encode(), "text/html; charset=utf-8")
        elif asked.path.startswith("/scenes/") and (name := asked.path[8:]) in self.server.study.scenes:
            self._send(HTTPStatus.OK, self.server.scene(name), "application/json", is_scene=True)
        else:
            raise Refused(HTTPStatus.NOT_FOUND, "there is nothing here; the study is at /")

    def _session(self, token: str) -> dict[str, Any]:
        rater = self._rater(token)
        return session_of(self.server.study, rater, self.server.store.answered(rater.name))

    def _rater(self, token: object) -> Rater:
        name = self.server.study.signer.rater_of(token)
        rater = self.server.store.rater(name)
        if rater is None or rater.place != "server":
            raise Forged("the session is not one of this page; open it by the link that was given")
        return rater

    def _post(self) -> None:
        content = self._content()
        study, store = self.server.study, self.server.store
        if self.path == "/raters":
            token = study.signer.session(store.enrol("server").name)
            self._send_json(HTTPStatus.CREATED, {"rater": token})
        elif self.path == "/answers":
            rater = self._rater(content.get("rater"))
            answered = store.save(checked_answer(study, rater.name, rater.number, content))
            self._send_json(HTTPStatus.CREATED, {"answered": answered, "of": study.design.turns})
        else:
            raise Refused(HTTPStatus.NOT_FOUND, "nothing is taken here")

    def _content(self) -> dict[str, Any]:
        """What was sent, a small JSON object. Its type makes browsers ask before another site's page may send it."""
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            self.close_connection = True  # what is not read would be taken for the next request
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a request must tell its length, at most {MOST_BYTES}")
        body = self.rfile.read(int(length))
        if self.headers.get_content_type() != "application/json":
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a request must be application/json")
        try:
            content = json.loads(body)
        except (ValueError, RecursionError) as error:
            raise Refused(HTTPStatus.BAD_REQUEST, "a request must be JSON") from error
        if not isinstance(content, dict):
            raise Refused(HTTPStatus.BAD_REQUEST, "a request must be a JSON object")
        return content

    def _refuse(self, status: HTTPStatus, why: object) -> None:
        if self.command == "POST":
            self._send_json(status, {"error": str(why)})
        else:
            self._send(status, REFUSAL.format(escape(str(why))).encode(), "text/html; charset=utf-8")

    def _send_json(self, status: HTTPStatus, content: dict[str, Any]) -> None:
        self._send(status, json.dumps(content).encode(), "application/json")

    def _send(self, status: HTTPStatus, body: bytes, kind: str, is_scene: bool = False) -> None:
        """Sends an answer; scenes are compressed already and never change, all else is asked again."""
        accepts = "gzip" in self.headers.get("Accept-Encoding", "")
        if is_scene and not accepts:
            body = gzip.decompress(body)
        elif accepts and not is_scene:
            body = gzip.compress(body, 5)
        kept = "private, max-age=86400, immutable" if is_scene else "no-store"
        headers = {**HEADERS, "Content-Type": kind, "Content-Length": str(len(body)), "Cache-Control": kept}
        if accepts:
            headers["Content-Encoding"] = "gzip"
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)
