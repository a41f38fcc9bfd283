"""Statistics of a campaign's table: success rates with intervals, paired comparisons of agents, mean metrics, costs."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from basu.campaigns.evidence import OWN
from basu.intervals import Interval, Paired, bootstrap, clopper_pearson, mcnemar, sign_test, wilson
from basu.output.report.event_rates import rate_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

HOUR_S = 3_600.0
OF_KIND, DISENGAGEMENTS, DRIVEN = "infractions_", "disengagements_number", "reported_driven_m"  # columns


class Rate(NamedTuple):
    """The success rate of an agent, in all or in a part of the drives."""

    agent: str
    drives: int
    judged: int
    successes: int
    wilson: Interval
    exact: Interval  # Clopper and Pearson
    shown: Interval  # Wilson, of all drives: what was not judged counts as not passed
    faults: dict[str, int]  # drives that say nothing of the agent, by the party at fault; without one: not exercised


class Pair(NamedTuple):
    """Two agents on the same conditions."""

    first: str
    second: str
    success: Paired
    score: Paired


class Mean(NamedTuple):
    """A mean of a column for an agent."""

    title: str
    unit: str
    digits: int
    by_agent: dict[str, Interval]


class CostOf(NamedTuple):
    """What the drives of an agent cost."""

    agent: str
    simulated_h: float
    cpu_s_per_h: float  # processor seconds for a simulated hour
    wall_s_per_drive: float
    record_bytes_per_h: float  # of a record's folder, for a simulated hour
    memory_mb: float  # largest of a worker with its simulator and agent


MEANS = (
    ("driving_score", "driving score", "", 3),
    ("passengers_comfort_score", "comfort score", "", 3),
    ("passengers_largest_braking_mps2", "hardest braking", "m/s²", 2),
    ("passengers_largest_jerk_along_mps3", "largest jerk along", "m/s³", 2),
    ("passengers_harm_near_misses", "near misses a drive", "", 3),
    ("reported_route_completion", "route completion", "", 3),
    ("delays_longest_rest_s", "longest rest", "s", 1),
)


def first_of_equal(table: pa.Table) -> NDArray[np.int64]:
    """Return for every row (N,) the number of the first row that is equal in condition and outcome but for the seed.

    A drive that does not react to its seed says the same thing again, so it is no independent evidence.
    """
    rows = pa.table(
        {name: table[name] for name in table.column_names if name not in OWN and not pa.types.is_null(table[name].type)}
    ).append_column("number", table["number"])
    keys = [name for name in rows.column_names if name != "number"]
    groups = rows.group_by(keys, use_threads=False).aggregate([("number", "min"), ("number", "list")])
    numbers = table["number"].to_numpy()
    members = groups["number_list"].combine_chunks()
    sizes = pc.list_value_length(members).to_numpy(zero_copy_only=False)
    first = np.repeat(groups["number_min"].to_numpy(), sizes)
    flat = members.flatten().to_numpy(zero_copy_only=False)
    order = np.argsort(flat)
    found: NDArray[np.int64] = first[order][np.searchsorted(flat[order], numbers)]
    return found


def distinct(table: pa.Table) -> pa.Table:
    """Return the rows without repetitions of another row under a different seed."""
    return table.filter(pa.array(first_of_equal(table) == table["number"].to_numpy()))


def rates(table: pa.Table, agents: Sequence[str], confidence: float) -> list[Rate]:
    """The success rate of every agent in a table."""
    return [_rate(table.filter(pc.equal(table["agent"], agent)), agent, confidence) for agent in agents]


def _rate(table: pa.Table, agent: str, confidence: float) -> Rate:
    judged = table.filter(table["judged"])
    successes = int(pc.sum(judged["success"]).as_py() or 0)
    rest = table.filter(pc.invert(table["judged"]))
    faults = {str(row["values"]): int(row["counts"]) for row in pc.value_counts(rest["fault"]).to_pylist()}
    trials = judged.num_rows
    exact = clopper_pearson(successes, trials, confidence)
    judged_rate, shown = (wilson(successes, number, confidence) for number in (trials, table.num_rows))
    return Rate(agent, table.num_rows, trials, successes, judged_rate, exact, shown, faults)


def pairs(table: pa.Table, agents: Sequence[str]) -> list[Pair]:
    """Return every two agents, compared on the conditions in which both were judged; equal pairs count once."""
    number, equal = table["number"].to_numpy() // len(agents), first_of_equal(table)
    names = np.array(table["agent"].to_pylist(), dtype=object)
    judged = table["judged"].to_numpy(zero_copy_only=False).astype(bool)
    success = np.array(table["success"].fill_null(False).to_numpy(zero_copy_only=False), dtype=bool)
    score = table["driving_score"].to_numpy(zero_copy_only=False).astype(np.float64)
    found = []
    for first, second in itertools.combinations(agents, 2):
        one, other = (np.flatnonzero((names == agent) & judged) for agent in (first, second))
        _, at_one, at_other = np.intersect1d(number[one], number[other], return_indices=True)
        one, other = one[at_one], other[at_other]
        _, kept = np.unique(np.stack([equal[one], equal[other]]), axis=1, return_index=True)  # equal pairs count once
        one, other = one[kept], other[kept]
        found.append(Pair(first, second, mcnemar(success[one], success[other]), sign_test(score[one], score[other])))
    return found


class Frequency(NamedTuple):
    """A kind of event on the way that an agent has driven."""

    agent: str
    driven_km: float
    event: str
    text: str  # number and rates


def frequencies(table: pa.Table, agents: Sequence[str]) -> list[Frequency]:
    """Return each kind of infraction, and the disengagements, for the distance of the drives that were judged."""
    columns = {name.removeprefix(OF_KIND): name for name in table.column_names if name.startswith(OF_KIND)}
    if DISENGAGEMENTS in table.column_names:
        columns["disengagements"] = DISENGAGEMENTS
    found = []
    for agent in agents:
        own = table.filter(pc.and_(pc.equal(table["agent"], agent), table["judged"]))
        driven_m = float(pc.sum(own[DRIVEN]).as_py() or 0.0)
        for event, column in columns.items():
            number = int(pc.sum(own[column]).as_py() or 0)
            if number or event == "disengagements":
                found.append(Frequency(agent, driven_m / 1000.0, event, rate_text(number, driven_m)))
    return found


def means(table: pa.Table, agents: Sequence[str], confidence: float) -> list[Mean]:
    """The means of comfort and service with bootstrap intervals, over the drives that say something of the agent."""
    judged = table.filter(table["judged"])
    found = []
    for column, title, unit, digits in MEANS:
        if column in table.column_names:
            values = {agent: _of(judged, agent, column) for agent in agents}
            found.append(Mean(title, unit, digits, {a: bootstrap(each, confidence) for a, each in values.items()}))
    return found


def services(table: pa.Table, agents: Sequence[str], confidence: float) -> dict[str, Interval]:
    """The share of service stops that each agent served; none for an agent without a stop on its way."""
    found = {}
    for agent in agents:
        own = table.filter(pc.and_(pc.equal(table["agent"], agent), table["judged"]))
        stops, served = (int(pc.sum(own[name]).as_py() or 0) for name in ("stops_number", "stops_served"))
        if stops:
            found[agent] = wilson(served, stops, confidence)
    return found


def costs(table: pa.Table, agents: Sequence[str]) -> list[CostOf]:
    """What the drives of each agent cost."""
    found = []
    for agent in agents:
        simulated_s, cpu_s, wall_s, data_bytes, memory_mb = (
            _of(table, agent, name) for name in ("simulated_s", "cpu_s", "wall_s", "records_bytes", "memory_mb")
        )
        hours = float(np.nansum(simulated_s)) / HOUR_S
        found.append(
            CostOf(
                agent,
                hours,
                float(np.nansum(cpu_s)) / hours if hours else math.nan,
                float(np.nanmean(wall_s)) if np.isfinite(wall_s).any() else math.nan,
                float(np.nansum(data_bytes)) / hours if hours else math.nan,
                float(np.nanmax(memory_mb)) if np.isfinite(memory_mb).any() else math.nan,
            )
        )
    return found


def breakdown(table: pa.Table, agents: Sequence[str], confidence: float) -> list[dict[str, Any]]:
    """The success rate in every subject and weather, the worst first."""
    grouped = table.filter(table["judged"]).group_by(["subject", "weather", "agent"])
    rows = grouped.aggregate([("success", "sum"), ("success", "count")]).to_pylist()
    cells: dict[tuple[str, str], dict[str, Interval]] = {}
    counts: dict[tuple[str, str], int] = {}
    for row in rows:
        key = (row["subject"], row["weather"])
        cells.setdefault(key, {})[row["agent"]] = wilson(int(row["success_sum"] or 0), row["success_count"], confidence)
        counts[key] = max(counts.get(key, 0), int(row["success_count"]))
    order = sorted(cells, key=lambda key: (min(each.value for each in cells[key].values()), key))
    return [
        {"subject": key[0], "weather": key[1], "drives": counts[key], "rates": [cells[key].get(a) for a in agents]}
        for key in order
    ]


def _of(table: pa.Table, agent: str, column: str) -> NDArray[np.float64]:
    """A column of one agent as numbers, NaN for null."""
    own = table.filter(pc.equal(table["agent"], agent))[column]
    values: NDArray[np.float64] = pc.cast(own, "float64").to_numpy(zero_copy_only=False)
    return values
