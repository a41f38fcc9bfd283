"""Claims about drives that do not react to their seed: they count once."""

import pyarrow as pa

from basu.campaigns.conclusions import distinct, first_of_equal, pairs, rates


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
