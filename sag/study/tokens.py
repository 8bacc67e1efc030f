"""Signatures: what a page is given comes back as it was given, or is refused."""

from __future__ import annotations

import base64
import hashlib
import hmac
from dataclasses import dataclass

from sag.errors import SagError

SIGNED = 16
"""Bytes of a signature: 128 bits."""

LONGEST = 200
"""Characters of a token that may be one."""


class Forged(SagError):
    """A token that this study has not signed."""


@dataclass(frozen=True)
class Signer:
    """Signs by a key that never leaves the study's private folder (HMAC with SHA-256).

    Attributes:
        key: of the study.
    """

    key: bytes

    def session(self, rater: str) -> str:
        """The token of a rater: who has it is the rater."""
        return f"{rater}.{self._signature('session', rater)}"

    def turn(self, rater: str, turn: int, item: str) -> str:
        """The token of a motion that this rater is shown at this turn."""
        return f"{turn}.{self._signature('turn', rater, str(turn), item)}"

    def identity(self, *about: str) -> str:
        """A name for something, which tells nothing about it."""
        return hmac.new(self.key, "\0".join(("name", *about)).encode(), hashlib.sha256).hexdigest()[:12]

    def rater_of(self, token: object) -> str:
        """Whose session it is.

        Raises:
            Forged: it is not of this study.
        """
        rater = _body(token)
        if not self._same(token, self.session(rater)):
            raise Forged("the session is not one of this study; open the page by the link that was given")
        return rater

    def turn_of(self, token: object, rater: str, items: list[str]) -> int:
        """Which of a rater's turns it is.

        Args:
            token: of the turn.
            rater: who was shown it.
            items: what the rater is shown, in order.

        Raises:
            Forged: it is not of this rater.
        """
        body = _body(token)
        turn = int(body) if body.isascii() and body.isdecimal() and len(body) < 6 else -1
        if not 0 <= turn < len(items) or not self._same(token, self.turn(rater, turn, items[turn])):
            raise Forged("the motion is not one that this session shows; load the page again")
        return turn

    def _signature(self, *parts: str) -> str:
        digest = hmac.new(self.key, "\0".join(parts).encode(), hashlib.sha256).digest()[:SIGNED]
        return base64.urlsafe_b64encode(digest).decode().rstrip("=")

    @staticmethod
    def _same(token: object, wanted: str) -> bool:
        return isinstance(token, str) and hmac.compare_digest(token.encode(errors="replace"), wanted.encode())


def _body(token: object) -> str:
    """What stands before the signature."""
    return token.partition(".")[0] if isinstance(token, str) and len(token) <= LONGEST else ""
