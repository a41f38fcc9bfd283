"""Claims about rates: what an agent leaves out of one denominator counts in the other."""

import pyarrow as pa
import pytest

from basu.campaigns.conclusions import Rate, rates


def rate(*rows: tuple[bool, bool | None, str]) -> Rate:
    """The rate of one agent over drives of (judged, success, fault)."""
    names = ("judged", "success", "fault")
    table = pa.Table.from_pylist([{"agent": "a", **dict(zip(names, row, strict=True))} for row in rows])
    return rates(table, ["a"], 0.95)[0]


PASSED, FAILED, ABSENT, SPOILED = (
    (True, True, "none"),
    (True, False, "none"),
    (False, None, "none"),
    (False, None, "setup"),
)


@pytest.mark.parametrize("avoided", [ABSENT, SPOILED], ids=["not exercised", "not judged"])
def test_a_failure_that_is_avoided_raises_no_rate_of_all_drives(avoided: tuple[bool, bool | None, str]) -> None:
    honest, absent = rate(*[PASSED] * 6, *[FAILED] * 4), rate(*[PASSED] * 6, *[avoided] * 4)
    assert (honest.wilson.value, absent.wilson.value) == (0.6, 1.0)
    assert absent.shown == honest.shown == honest.wilson
    assert absent.drives == 10
