"""`Study`: the judged cases of one sampled scenario with one agent, as columns of varied parameters and verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.output.report.scenarios.tally import LOOKS, blocks

if TYPE_CHECKING:
    from numpy.typing import NDArray

LEAST_CASES = 8  # fewer tell nothing about a boundary


class Axis(NamedTuple):
    """A parameter that varied."""

    name: str
    unit: str
    about: str
    values: NDArray[np.float64]  # (N,); of a choice, the number of its option
    options: tuple[str, ...]  # of a choice, in alphabetical order; none for a number

    @property
    def low(self) -> float:
        """The least value."""
        return float(self.values.min())

    @property
    def high(self) -> float:
        """The greatest value."""
        return float(self.values.max())

    def share(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values as shares of the axis's reach."""
        return (values - self.low) / max(self.high - self.low, 1e-12)


class Study(NamedTuple):
    """One scenario sampled with one agent; only judged cases are in the columns."""

    scenario: str
    agent: str
    ids: list[str]
    axes: list[Axis]
    failed: NDArray[np.bool_]  # (N,), an agent's own faults with them
    broken: NDArray[np.bool_]  # (N,), which of those were faults
    distance_m: NDArray[np.float64]  # (N,) the least, nan where no actor was near
    unjudged: int  # cases that are left out, those not exercised included
    absent: int  # of those, not exercised: they neither pass nor fail

    @property
    def is_mixed(self) -> bool:
        """Whether there is a boundary to look for."""
        return bool(self.failed.any() and not self.failed.all())


def studies(matrix: dict[str, Any]) -> list[Study]:
    """Return all of a matrix: of each scenario that was sampled, each agent."""
    if matrix["sweep"] is None:
        return []
    found = []
    for block in blocks(matrix):
        for row in block.rows:
            for agent in matrix["agents"]:
                study = _study(row.scenario, agent, row.cases)
                if study is not None:
                    found.append(study)
    return found


def _study(scenario: str, agent: str, cases: list[dict[str, Any]]) -> Study | None:
    """One of them; None where too little was driven or nothing varied."""
    driven = [(case, case["results"][agent]) for case in cases if agent in case["results"]]
    judged = [(case, result) for case, result in driven if LOOKS[result["verdict"]].is_judged]
    if len(judged) < LEAST_CASES:
        return None
    axes = [axis for axis in _axes([case for case, _ in judged]) if axis.high > axis.low]
    if not axes:
        return None
    distances = [result["margins"].get("distance_m") for _, result in judged]
    return Study(
        scenario=scenario,
        agent=agent,
        ids=[case["id"] for case, _ in judged],
        axes=axes,
        failed=np.array([result["verdict"] != "SUCCESS" for _, result in judged]),
        broken=np.array([result["verdict"] == "AGENT_FAULT" for _, result in judged]),
        distance_m=np.array([np.nan if value is None else value for value in distances], dtype=np.float64),
        unjudged=len(driven) - len(judged),
        absent=sum(result["verdict"] == "NOT_EXERCISED" for _, result in driven),
    )


def _axes(cases: list[dict[str, Any]]) -> list[Axis]:
    """Return every parameter as a column, and last the case that was sampled: several may be, each at its place."""
    found = [
        axis_of(
            parameter["name"],
            parameter["unit"],
            parameter["about"],
            [case["parameters"][number]["value"] for case in cases],
        )
        for number, parameter in enumerate(cases[0]["parameters"])
    ]
    return [*found, axis_of("case", "", "that was sampled", [case["id"].partition(":")[0] for case in cases])]


def axis_of(name: str, unit: str, about: str, values: list[float | str]) -> Axis:
    """Return a parameter's values as numbers."""
    if not any(isinstance(value, str) for value in values):
        return Axis(name, unit, about, np.array(values, dtype=np.float64), ())
    options = tuple(sorted({str(value) for value in values}))
    numbers = {option: float(number) for number, option in enumerate(options)}
    return Axis(name, unit, about, np.array([numbers[str(value)] for value in values]), options)
