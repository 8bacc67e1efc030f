"""Studies without a trained network, and raters who answer them over HTTP."""

from __future__ import annotations

import http.client
import json
import re
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from viewer_windows import window

from sag.skeleton import GTA_IM_19
from sag.study.folder import TRUTH, Settings, Study
from sag.study.making import fill
from sag.study.server import StudyServer
from sag.study.store import Store
from sag.study.writing import new_study

METHODS = ("none", "md", "mdpc")


def toy_study(
    folder: Path, scenes: int = 3, methods: Sequence[str] = METHODS, repeats: int = 2, note: str = "", **changes: Any
) -> Study:
    """A study of made-up walks before a wall."""
    settings = {
        "title": "How do these motions look?", "data": "rooms", "fingerprint": "abc", "fps": 30.0, "frames": 65,
        "methods": (*methods, TRUTH), "windows": tuple(range(1000, 1000 + scenes)), "rounds": len(methods) + 1,
        "repeats": repeats, "sampling_seed": 0, "made": "2030-01-02T03:04:05Z", "version": "1", **changes,
    }  # fmt: skip
    study = new_study(folder, Settings(**settings))
    fill(study, [window(f"room {place}", tuple(methods), samples=1) for place in range(scenes)], GTA_IM_19, note)
    return study


@contextmanager
def served(study: Study) -> Iterator[StudyServer]:
    """The study on a free port of this machine, in a thread."""
    store = Store(study.answers)
    server = StudyServer(study, store, ("127.0.0.1", 0))
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
        store.close()


def inlined(page: str, name: str) -> Any:
    """A JSON element of a page."""
    return json.loads(
        re.search(rf'<script id="{name}" type="application/json">(.*?)</script>', page, re.DOTALL).group(1)
    )


class Client:
    """Somebody who answers, or tries to.

    Args:
        port: of the server, on this machine.
    """

    def __init__(self, port: int) -> None:
        self.port, self.rater = port, ""

    def ask(self, method: str, path: str, body: bytes | None = None, **headers: str) -> tuple[int, bytes, Any]:
        """Status, content and headers of an answer, on a connection of its own."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
            answer = connection.getresponse()
            return answer.status, answer.read(), answer.headers
        finally:
            connection.close()

    def post(self, path: str, content: Any) -> tuple[int, Any]:
        """Status and content of what is answered to JSON."""
        status, body, _ = self.ask("POST", path, json.dumps(content).encode(), Content_Type="application/json")
        return status, json.loads(body)

    def begin(self) -> Client:
        """Begins a session."""
        status, content = self.post("/raters", {})
        assert status == 201, content
        self.rater = content["rater"]
        return self

    @property
    def session(self) -> dict[str, Any]:
        """What the page is told."""
        status, body, _ = self.ask("GET", f"/?rater={self.rater}")
        assert status == 200, body
        return inlined(body.decode(), "session")

    def answer(self, turn: str, scene: object = 4, human: object = 2, **changes: Any) -> tuple[int, Any]:
        """Status and content of what is said to an answer."""
        scores = {"scene": scene, "human": human}
        content = {"rater": self.rater, "turn": turn, "scores": scores, "seconds": 3.5, "plays": 2, **changes}
        return self.post("/answers", content)
