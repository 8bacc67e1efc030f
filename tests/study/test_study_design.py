"""Who sees what when: squares and sessions are balanced."""

from collections import Counter
from itertools import pairwise

import pytest

from sag.errors import SagError
from sag.study.design import Design, Item, williams


@pytest.mark.parametrize("count", range(2, 9))
def test_a_williams_square_is_latin_and_everything_follows_everything_equally_often(count):
    rows = williams(count)
    assert len(rows) == count * (1 + count % 2)
    for place in range(count):
        assert set(Counter(row[place] for row in rows).values()) == {len(rows) // count}
    follows = Counter(pair for row in rows for pair in pairwise(row))
    assert len(follows) == count * (count - 1) and len(set(follows.values())) == 1


def rounds(design: Design, rater: int) -> list[list[Item]]:
    """The rounds of a session without motions that come again."""
    items = Design(design.scenes, design.methods, design.rounds, 0, design.seed).session(rater)
    return [items[first : first + design.scenes] for first in range(0, len(items), design.scenes)]


@pytest.mark.parametrize(("scenes", "methods"), [(8, 4), (5, 3), (20, 4)])
def test_over_raters_every_method_comes_in_every_round_of_every_scene(scenes, methods):
    design = Design(scenes, methods, methods, 0, "seed")
    raters = len(williams(methods))
    seen = Counter(
        (place, item) for rater in range(raters) for place, one in enumerate(rounds(design, rater)) for item in one
    )
    assert len(seen) == scenes * methods * methods and set(seen.values()) == {raters // methods}


def test_every_rater_sees_every_motion_once_and_no_scene_twice_in_a_row():
    design = Design(8, 4, 4, 0, "seed")
    for rater in range(12):
        items = design.session(rater)
        assert len(set(items)) == len(items) == 32
        assert all(one.scene != other.scene for one, other in pairwise(items))
        for one in rounds(design, rater):
            assert sorted(item.scene for item in one) == list(range(8))
            assert set(Counter(item.method for item in one).values()) == {2}


def test_fewer_rounds_show_each_scene_less_often():
    items = Design(8, 4, 1, 0, "seed").session(3)
    assert sorted(item.scene for item in items) == list(range(8)) and {item.method for item in items} == {0, 1, 2, 3}


def test_motions_come_again_late_and_apart():
    design = Design(20, 4, 4, 4, "seed")
    for rater in range(6):
        items = design.session(rater)
        assert len(items) == design.turns == 84
        twice = [item for item, count in Counter(items).items() if count == 2]
        assert len(twice) == 4
        for item in twice:
            first, second = (place for place, one in enumerate(items) if one == item)
            assert first < 28 and second >= 52
            assert all(items[near].scene != item.scene for near in (second - 1, second + 1) if near < len(items))


def test_a_session_is_the_same_again_and_another_for_others():
    design = Design(6, 4, 4, 2, "seed")
    assert design.session(3) == design.session(3) != design.session(4)
    assert design.session(3) != Design(6, 4, 4, 2, "other").session(3)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [((4, 1, 1, 0), "name at least one run"), ((4, 3, 4, 0), "--rounds is 4"), ((4, 3, 3, 4), "--repeats is 4; of 12")],
)
def test_refuses(numbers, said):
    with pytest.raises(SagError, match=said):
        Design(*numbers, "seed")
