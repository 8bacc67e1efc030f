"""Effects of the letters: planted ones are found, and intervals hold them as often as they say."""

import math

import numpy as np
import pytest

from sag.letters import LETTERS, components_of, row_name
from sag.report.effects import EVERY, effects_of
from sag.report.letters import letters_of, letters_tables, verdict_of
from sag.report.lines import Line, lines_of
from sag.report.measures import AWARENESS, INSIDE, MEASURES, MOTION_FID, NON_COLLISION, OWN, PROBE
from sag.report.results import Result

ROWS = [row_name(dict(zip(LETTERS, cell))) for cell in EVERY]
TABLE_1 = ["none", "m", "md", "mdc", "mdp", "mdpc"]
METRIC = NON_COLLISION.metric


def made(rows, seeds, figure, metric=METRIC) -> list[Line]:
    """Lines whose figure is a function of letters and seed."""
    results = [
        Result(
            f"{row}-s{s}", components=components_of(row), seed=s, metrics={metric: figure(row.replace("none", ""), s)}
        )
        for row in rows
        for s in seeds
    ]
    return lines_of(results)


def found(lines, measure=NON_COLLISION):
    return {effect.name: effect for effect in effects_of(lines, measure)}


def planted(letters, seed):
    """Main effects of 1 and -2, an interaction of 0.5 in +-1 coding (so twice that), a shift of the whole seed."""
    c, p = (1 if letter in letters else -1 for letter in "cp")
    return 0.5 * ("m" in letters) * 2 - 2 * ("d" in letters) + 0.5 * c * p + 10 * seed


def test_planted_effects_are_found_exactly_and_what_a_seed_does_to_all_rows_is_no_error():
    effects = found(made(ROWS, range(3), planted))
    wanted = {"M": 1.0, "D": -2.0, "P": 0.0, "C": 0.0, "P×C": 1.0, "M×D": 0.0}
    assert {name: effects[name].estimate.value for name in wanted} == pytest.approx(wanted, abs=1e-9)
    assert effects["M"].twins == 8 and effects["P×C"].twins == 4
    assert {(e.source, e.freedom) for e in effects.values()} == {("seeds", 16 * 3 - 16 - 2)}
    assert effects["M"].estimate.high - effects["M"].estimate.low < 1e-6
    assert len(effects) == 4 + 6


def noisy(rng, spread=1.0):
    return lambda letters, seed: planted(letters, seed) + rng.normal(0, spread)


def test_effects_are_those_of_least_squares_in_plus_minus_coding():
    rng = np.random.default_rng(3)
    lines = made(ROWS, range(2), noisy(rng))
    names = list(found(lines))
    cells = [[1 if line.components[c] else -1 for c in LETTERS] for line in lines for _ in range(2)]
    letters = list(LETTERS.values())
    design = [[1] + [math.prod(cell[letters.index(x)] for x in name.split("×")) for name in names] for cell in cells]
    values = [value for line in lines for _, value in sorted(line.values(METRIC).items())]
    coefficients = np.linalg.lstsq(np.array(design, float), np.array(values), rcond=None)[0][1:]
    assert [found(lines)[name].estimate.value for name in names] == pytest.approx((2 * coefficients).tolist())


@pytest.mark.parametrize(("rows", "seeds", "freedom"), [(ROWS, 1, 5), (ROWS, 2, 15), (TABLE_1, 5, 4)])
def test_intervals_hold_the_truth_as_often_as_they_say(rows, seeds, freedom):
    rng = np.random.default_rng(0)
    held, count = [], 150
    for _ in range(count):
        effects = found(made(rows, range(seeds), noisy(rng)))
        assert effects["M"].freedom == freedom
        held += [effects[n].estimate.low <= truth <= effects[n].estimate.high for n, truth in {"M": 1, "D": -2}.items()]
    assert np.mean(held) == pytest.approx(0.95, abs=0.03)


def test_rows_that_an_effect_does_not_compare_have_no_say_in_its_interval():
    """Without M seeds scatter a hundred times as much; P and C are told from four rows with M."""
    rng = np.random.default_rng(1)
    quiet = {(row, seed): rng.normal() for row in TABLE_1 for seed in range(5)}

    def scattered(by):
        return lambda row, seed: planted(row, seed) + quiet[row or "none", seed] * (1 if row else by)

    lines, loud = (made(TABLE_1, range(5), scattered(by)) for by in (1, 100))
    for name in ("P", "C", "P×C"):
        assert found(loud)[name].estimate == found(lines)[name].estimate
        assert found(loud)[name].freedom == 4 * 5 - 4 - 4
    assert found(loud)["M"].estimate.high - found(loud)["M"].estimate.low > 20


def test_one_seed_takes_its_error_from_higher_interactions():
    def figure(letters, seed):
        return planted(letters, 0) + 0.3 * math.prod(1 if x in letters else -1 for x in "mdpc")

    effects = found(made(ROWS, [0], figure))
    assert {(e.source, e.freedom) for e in effects.values()} == {("interactions", 5)}
    half = 2.570582 * math.sqrt(16 * 0.3**2 / 5 / 4)
    assert effects["M"].estimate.high - 1 == pytest.approx(half, rel=1e-5)


def test_some_rows_give_the_twins_there_are():
    effects = found(made(TABLE_1, range(3), planted))
    assert {name: e.twins for name, e in effects.items() if e.twins} == {"M": 1, "D": 1, "P": 2, "C": 2, "P×C": 1}
    wanted = {"M": 1.0, "D": -2.0, "P": 0.0, "C": 0.0, "P×C": 1.0}
    assert {name: effects[name].estimate.value for name in wanted} == pytest.approx(wanted, abs=1e-9)
    assert effects["M×D"].estimate is None


def test_one_seed_of_some_rows_has_no_interval_and_no_table():
    lines = made(TABLE_1, [0], planted)
    assert {effect.source for effect in found(lines).values()} == {""}
    assert found(lines)["M"].estimate.low is None
    assert not letters_tables(letters_of(lines))


def test_seeds_that_rows_do_not_share_are_no_blocks():
    one, other = made(["none"], [0, 1], planted), made(["m"], [2, 3], planted)
    effects = found(one + other)
    assert effects["M"].estimate.value == pytest.approx(21.0) and effects["M"].freedom == 2


def test_missing_seeds_do_not_shift_an_effect():
    lines = made(["none"], [0, 1, 2], planted) + made(["m"], [1, 2], planted)
    assert found(lines)["M"].estimate.value == pytest.approx(1.0), "seed 0 alone is 10 and 20 below the others"


def test_nan_makes_what_rests_on_it_nan_and_nothing_else():
    lines = made(TABLE_1, range(2), lambda letters, seed: math.nan if letters == "" else planted(letters, seed))
    effects = found(lines)
    assert math.isnan(effects["M"].estimate.value) and effects["D"].estimate.value == pytest.approx(-2.0)
    assert verdict_of(effects["M"]) == ("NaN", "bad")


def test_ratios_are_compared_on_the_logarithmic_scale():
    lines = made(ROWS, range(2), lambda letters, seed: 8.0 * 0.25 ** ("m" in letters), MOTION_FID.metric)
    estimate = found(lines, MOTION_FID)["M"].estimate
    assert MOTION_FID.written(estimate.value) == "×0.250"
    zero = made(ROWS, range(2), lambda letters, seed: float("m" in letters), MOTION_FID.metric)
    assert math.isnan(found(zero, MOTION_FID)["M"].estimate.value), "0 has no logarithm"


def test_variants_and_the_blind_row_are_no_cells():
    lines = made(["none", "m"], range(2), planted)
    variant = Result("m-rate=1-s0", components=components_of("m"), seed=0, metrics={METRIC: 99.0})
    blind = Result("blind-s0", components=components_of("m"), seed=0, metrics={METRIC: 99.0})
    assert found(lines + lines_of([variant, blind]))["M"].estimate.value == pytest.approx(1.0)


def test_permuting_seeds_changes_no_effect():
    rng = np.random.default_rng(1)
    values = {(row, seed): rng.normal() for row in ROWS for seed in range(3)}
    swapped = {0: 2, 1: 0, 2: 1}
    one = found(made(ROWS, range(3), lambda x, s: values[x or "none", s]))
    other = found(made(ROWS, range(3), lambda x, s: values[x or "none", swapped[s]]))
    for name, effect in one.items():
        assert (effect.estimate.low, effect.estimate.high) == pytest.approx(
            (other[name].estimate.low, other[name].estimate.high)
        )


@pytest.mark.parametrize(
    ("change", "verdict"), [(-0.1, "holds"), (0.1, "points the other way"), (0.0, "does not hold")]
)
def test_verdicts_follow_the_expected_side(change, verdict):
    jitter = {0: 0.01, 1: -0.01, 2: 0.0}
    lines = made(
        ["md", "mdc"],
        range(3),
        lambda x, s: 0.2 + change * ("c" in x) + jitter[s] * (1 if "c" in x else -1),
        INSIDE.metric,
    )
    effect = found(lines, INSIDE)["C"]
    assert verdict_of(effect)[0] == verdict


def test_every_letter_has_its_own_measure_and_what_cannot_be_told_is_said():
    assert {component for component, _ in OWN} == set(LETTERS)
    assert all(measure in MEASURES for _, measure in OWN)
    lines = made(TABLE_1, range(2), lambda x, s: 1.0 + s + len(x), MOTION_FID.metric)
    deep = made(["md", "mdc"], range(2), lambda x, s: 0.4 + s, PROBE.metric)
    own, *_ = letters_tables(letters_of([*lines, *deep]))
    texts = {(row.cells[0].text, row.cells[1].text): row.cells[-1].text for row in own.rows}
    assert texts["D", f"{PROBE.name} {PROBE.unit}"] == "no twins"
    assert texts["D", AWARENESS.name] == "not measured"
