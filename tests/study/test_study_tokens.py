"""Tokens: only what was signed here, for this rater and this turn, is taken."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sag.study.tokens import Forged, Signer

OURS, THEIRS = Signer(b"k" * 32), Signer(b"l" * 32)
ITEMS = ["a", "b", "a"]


def test_what_was_signed_comes_back():
    assert OURS.rater_of(OURS.session("ann")) == "ann"
    assert [OURS.turn_of(OURS.turn("ann", turn, item), "ann", ITEMS) for turn, item in enumerate(ITEMS)] == [0, 1, 2]


def test_names_tell_nothing_and_differ():
    names = [OURS.identity("motion", "1", "2"), OURS.identity("motion", "12", ""), THEIRS.identity("motion", "1", "2")]
    assert len(set(names)) == 3 and all(len(name) == 12 for name in names)


@pytest.mark.parametrize(
    "token",
    [
        THEIRS.turn("ann", 1, "b"), OURS.turn("bob", 1, "b"), OURS.turn("ann", 0, "b"), OURS.turn("ann", 1, "a"),
        "2." + OURS.turn("ann", 0, "a")[2:], OURS.turn("ann", 1, "b") + "x", OURS.turn("ann", 1, "b")[:-1], "1.", "1",
        "-1." + OURS.turn("ann", 1, "b")[2:], "９.x", "", None, 1, [], {}, "9" * 500, "\ud800", "1." + "é" * 22,
    ],
)  # fmt: skip
def test_forged_turns_are_refused(token):
    with pytest.raises(Forged):
        OURS.turn_of(token, "ann", ITEMS)


@given(st.one_of(st.text(max_size=60), st.integers(), st.none(), st.booleans(), st.floats()))
def test_forged_sessions_are_refused(token):
    with pytest.raises(Forged):
        OURS.rater_of(token)


def test_a_session_of_another_key_is_refused():
    with pytest.raises(Forged):
        OURS.rater_of(THEIRS.session("ann"))
