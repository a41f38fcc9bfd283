"""Claims about parameters that a case narrows for its place."""

import pytest

from basu.errors import ScenarioError
from basu.scenarios.parameters import Choice, Number, narrowed, read_values

AHEAD = Number("ahead", 40.0, 20.0, 80.0, "m", "to where it stands")
SIDE = Choice("side", ("left", "opposite", "right"), "from which it comes")


def test_a_case_without_limits_leaves_parameters_as_they_are() -> None:
    assert narrowed((AHEAD, SIDE), {"ahead": "30"}) == ((AHEAD, SIDE), {"ahead": "30"})


def test_a_number_is_left_a_part_of_its_range_and_a_choice_some_of_its_options() -> None:
    limits = {"ahead": "30", "ahead_low": "25", "ahead_high": "38.5", "side_among": "right opposite"}
    (ahead, side), values = narrowed((AHEAD, SIDE), limits)
    assert (ahead, side) == (AHEAD._replace(low=25.0, high=38.5), SIDE._replace(options=("opposite", "right")))
    assert read_values((ahead, side), values) == {"ahead": 30.0, "side": "opposite"}
    with pytest.raises(ScenarioError, match=r"'ahead' is '39'; it must be a number from 25 to 38\.5 m"):
        read_values((ahead, side), {"ahead": "39"})


def test_one_end_is_enough() -> None:
    ((ahead,), _) = narrowed((AHEAD,), {"ahead_high": "60"})
    assert ahead == AHEAD._replace(high=60.0)


def test_a_parameter_that_is_called_so_itself_is_no_limit() -> None:
    named_so = Number("ahead_low", 1.0, 0.0, 2.0, "m", "something else")
    assert narrowed((AHEAD, named_so), {"ahead_low": "1.5"}) == ((AHEAD, named_so), {"ahead_low": "1.5"})


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"ahead_low": "10"}, "'ahead' is '10'; it must be a number from 20 to 80 m"),
        ({"ahead_high": "far"}, "'ahead' is 'far'; it must be a number from 20 to 80 m"),
        ({"ahead": "30", "ahead_low": "60", "ahead_high": "60"}, "from 60 to 60; low must be below high"),
        ({"ahead_low": "60"}, r"from 60 to 80, and is 40 unless the case says otherwise; write <ahead value"),
        ({"side_among": "left behind"}, "'side' is 'behind'; it must be one of left, opposite, right"),
        ({"side_among": " "}, "'side' is left nothing; it may be among left opposite right"),
    ],
)
def test_limits_that_leave_nothing_get_a_sentence(given: dict[str, str], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        narrowed((AHEAD, SIDE), given)
