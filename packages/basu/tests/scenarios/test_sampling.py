"""Claims about sampling: every stratum is met once, choices are balanced, and a seed always gives the same texts."""

import itertools
import math
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.errors import ScenarioError
from basu.scenarios.parameters import Choice, Number, Parameter
from basu.scenarios.sampling import LIMIT, Grid, Sweep, check_design, draw

SPEED = Number("speed", 5.0, 2.0, 10.0, "m/s", "of the leader")
GAP = Number("gap", 1.0, 0.5, 2.0, "s", "before it brakes")
KIND = Choice("kind", ("car", "motorcycle", "bicycle"), "the leader")


@st.composite
def numbers(draw_from: st.DrawFn) -> Number:
    low = draw_from(st.floats(-1e3, 1e3))
    width = draw_from(st.floats(1e-3, 1e4))
    return Number("n", low, low, low + width, "", "")


@given(number=numbers(), samples=st.integers(1, 300), seed=st.integers(0, 2**32))
def test_a_sweep_meets_each_stratum_of_a_number_once(number: Number, samples: int, seed: int) -> None:
    values = [number.read(row["n"]) for row in draw(Sweep(samples, seed), [number])]
    strata = [math.floor((value - number.low) / (number.high - number.low) * samples) for value in values]
    assert sorted(strata) == list(range(samples))


@given(samples=st.integers(1, 300), seed=st.integers(0, 2**32))
def test_a_sweep_takes_each_option_as_often_as_any_other(samples: int, seed: int) -> None:
    counts = Counter(row["kind"] for row in draw(Sweep(samples, seed), [KIND]))
    assert sum(counts.values()) == samples
    assert max(counts.values()) - min(counts[option] for option in KIND.options) <= 1


def test_a_sweep_gives_the_same_texts_on_every_machine() -> None:
    assert draw(Sweep(4, 7), [SPEED, GAP, KIND]) == [
        {"speed": "5.899", "gap": "1.9357", "kind": "car"},
        {"speed": "7.379", "gap": "0.8632", "kind": "motorcycle"},
        {"speed": "3.021", "gap": "1.1849", "kind": "car"},
        {"speed": "8.655", "gap": "1.3091", "kind": "bicycle"},
    ]


def test_a_parameter_has_the_same_values_whatever_else_is_varied() -> None:
    alone = [row["speed"] for row in draw(Sweep(20, 3), [SPEED])]
    assert [row["speed"] for row in draw(Sweep(20, 3), [GAP, KIND, SPEED])] == alone


def test_another_seed_gives_other_values() -> None:
    assert draw(Sweep(20, 3), [SPEED]) != draw(Sweep(20, 4), [SPEED])


def test_two_numbers_of_a_sweep_are_not_one() -> None:
    rows = draw(Sweep(200, 0), [SPEED, GAP])
    speed = [(float(row["speed"]) - 2.0) / 8.0 - 0.5 for row in rows]
    gap = [(float(row["gap"]) - 0.5) / 1.5 - 0.5 for row in rows]
    covariance = sum(a * b for a, b in zip(speed, gap, strict=True)) / 200
    assert abs(covariance) < 0.25 / 12  # a quarter of what two equal columns have, 1/12


def test_a_grid_is_every_value_by_every_other_and_every_option() -> None:
    rows = [tuple(row.values()) for row in draw(Grid(3), [SPEED, KIND])]
    assert rows == list(itertools.product(("2", "6", "10"), KIND.options))


@given(number=numbers(), steps=st.integers(2, 50))
def test_a_grid_goes_from_the_lowest_to_the_highest_and_stays_within(number: Number, steps: int) -> None:
    values = [number.read(row["n"]) for row in draw(Grid(steps), [number])]
    assert values[0] == pytest.approx(number.low, abs=1e-6)
    assert values[-1] == pytest.approx(number.high, abs=1e-6)
    assert values == sorted(values)


@pytest.mark.parametrize(
    ("design", "parameters", "sentence"),
    [
        (Sweep(0, 0), [SPEED], "a sweep of 0 is none"),
        (Sweep(LIMIT + 1, 0), [SPEED], "sweep has 10,001 cases and may have 10,000; take fewer"),
        (Sweep(5, -1), [SPEED], "the seed of a sweep is -1"),
        (Grid(1), [SPEED], "a grid of 1 is none; 2 steps are the lowest and the highest"),
        (
            Grid(60),
            [SPEED, GAP, KIND],
            r"grid of 3 parameters \(speed, gap, kind\) has 10,800 cases .*name with --vary",
        ),
    ],
)
def test_a_design_that_no_actor_could_drive_is_refused(
    design: Sweep | Grid, parameters: list[Parameter], sentence: str
) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        check_design(design, parameters)
