"""Claims about drives that do not react to their seed: they count once."""

import pyarrow as pa
import pytest

from basu.campaigns.conclusions import distinct, first_of_equal, pairs, rates
from basu.campaigns.evidence import AgentEvidence
from basu.campaigns.looks import Looks
from basu.campaigns.settings import Until


def table(seeds: int) -> pa.Table:
    """Ten conditions of two agents, each driven with so many seeds that change nothing; the second fails in all."""
    rows = [
        {
            "number": 2 * (10 * seed + condition) + agent,
            "id": f"{seed}-{condition}-{agent}",
            "agent": ("a", "b")[agent],
            "identity": f"case_{condition}",
            "seed": seed,
            "judged": True,
            "success": agent == 0,
            "fault": "none",
            "driving_score": 1.0 - 0.5 * agent,
            "margin_distance_m": None if condition == 3 else float(condition),
            "wall_s": 1.0 + seed,
            "worker": seed,
        }
        for seed in range(seeds)
        for condition in range(10)
        for agent in range(2)
    ]
    return pa.Table.from_pylist(rows)


def test_seeds_that_change_nothing_leave_intervals_and_tests_as_they_were() -> None:
    one, three = table(1), table(3)
    assert (three.num_rows, distinct(three).num_rows) == (60, 20)
    assert rates(distinct(three), ["a", "b"], 0.95) == rates(one, ["a", "b"], 0.95)
    assert pairs(three, ["a", "b"]) == pairs(one, ["a", "b"])
    assert pairs(one, ["a", "b"])[0].success.pairs == 10


def test_a_drive_that_its_seed_changed_stays_and_pairs_with_the_other_agents_equal_one() -> None:
    three = table(3)
    column = three.column_names.index("driving_score")
    changed = [0.4 if row["number"] == 21 else row["driving_score"] for row in three.to_pylist()]
    three = three.set_column(column, "driving_score", pa.array(changed))
    assert distinct(three).num_rows == 21
    assert first_of_equal(three)[21] == 21
    assert pairs(three, ["a", "b"])[0].success.pairs == 11


@pytest.mark.parametrize("seeds", [1, 3])
def test_rows_counted_one_by_one_and_a_filtered_table_are_the_same_evidence(seeds: int) -> None:
    evidence = AgentEvidence()
    for row in table(seeds).to_pylist():
        evidence.add(row)
    assert [evidence.of(agent) for agent in ("a", "b")] == [
        (rate.judged, rate.successes) for rate in rates(distinct(table(seeds)), ["a", "b"], 0.95)
    ]


def test_repeated_drives_do_not_stop_a_campaign() -> None:
    rows = table(3).to_pylist()
    blocks = [rows[first : first + 20] for first in (0, 20, 40)]
    for least, stopped_after in ((10, 1), (11, None)):
        until = Until(width=0.4, least=least, every=10)
        looks = Looks(until, ["a", "b"], 0.95, blocks.__getitem__)
        for block in range(3):
            looks.complete(block)
        assert looks.stopped_after == stopped_after
