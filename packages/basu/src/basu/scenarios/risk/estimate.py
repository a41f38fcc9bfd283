"""Expected crashes, injuries, falls and disengagements for a million miles, from the cases that an agent played.

The sum over the groups of conflicts for a million miles (`exposure`) times the probability that a conflict of the group
ends so. A group's probability is that of its scenarios, weighted by the frequency of the pre-crash scenarios that they
stand for. Each case ends in one way:

- *crash*: the ego touched something.
- *disengagement*: no contact, and a person would have had to take over: the drive was not completed, the agent broke
  down, or the case was failed. A driver that stands still or creeps ends here.
- *passed*.
- *unknown*: the drive was completed and the conflict did not come about. Each such case may be a crash, so it widens
  the interval by all of itself.

An interval has 95 % of 4,000 draws of everything uncertain: the probabilities (beta distributions with Jeffreys' prior,
one for each scenario), the conflicts behind a reported crash or the counted ones, the injury curves, and the part of
the unknown cases that are crashes (0 to 1, one for the whole agent). Where no case of a scenario had an impact, the
draws suppose impacts at the shuttle's highest speed.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.intervals import Interval
from basu.metrics.passengers.balance import FREE_MPS2, SPREAD, share_that_falls
from basu.records.partners import Partner
from basu.scenarios.nhtsa import PER_1E9_MILES, Group
from basu.scenarios.risk.exposure import REPORTED, Exposure, drawn_encounters, encounters, reported_crashes
from basu.scenarios.risk.injuries import Curves, drawn, middle, severe
from basu.scenarios.shares import scenario_weights
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from basu.scenarios.shares import CountedCase

DRAWS, SEED = 4_000, 1_855
SUPPOSED_MPS = 6.7  # of the impacts that draws have in a scenario without one: as fast as the shuttle drives
KINDS = ("crashes", "severe injuries on foot", "deaths of occupants", "falls of a standing passenger", "disengagements")
CRASH, DISENGAGEMENT, PASSED, UNKNOWN = "crash", "disengagement", "passed", "unknown"
LEFT_OUT = (Verdict.SIMULATOR_FAULT, Verdict.SETUP_FAULT, Verdict.BENCHMARK_FAULT, Verdict.INTERRUPTED)


class PlayedCase(NamedTuple):
    """What risk needs to know of a case with one agent."""

    counted: CountedCase
    completed: bool
    partner: Partner
    impact_mps: float | None = None  # of the ego's fastest collision; None without one
    braking_mps2: float = 0.0  # the hardest that a standing passenger felt

    @property
    def end(self) -> str:
        """Return how the case ended."""
        if self.impact_mps is not None:
            return CRASH
        if self.counted.verdict is Verdict.SUCCESS:
            return PASSED
        return UNKNOWN if self.counted.verdict is Verdict.NOT_EXERCISED and self.completed else DISENGAGEMENT


class GroupRisk(NamedTuple):
    """One group of the typology."""

    group: Group
    encounters: float  # for a million miles
    reported: float  # crashes of human drivers for a million miles: table 1.1
    cases: int
    ends: Mapping[str, int]


class Risk(NamedTuple):
    """What an agent is expected to do in a million miles of the measured groups' conflicts."""

    rates: Mapping[str, Interval]  # by `KINDS`
    groups: tuple[GroupRisk, ...]
    unmeasured: tuple[Group, ...]
    left_out: int  # cases that a fault of others ended

    @property
    def events(self) -> float:
        """Crashes and disengagements together: what a service cannot have."""
        return self.rates["crashes"].value + self.rates["disengagements"].value


def risk(played: Iterable[PlayedCase], counted: Exposure | None = None) -> Risk:
    """Return an agent's risk; ``counted`` replaces the conflicts that follow from table 1.1."""
    counted = counted or {}
    every = list(played)
    known = [case for case in every if case.counted.verdict not in LEFT_OUT]
    by_group = {group: [case for case in known if case.counted.group is group] for group in PER_1E9_MILES}
    measured = {group: cases for group, cases in by_group.items() if cases}
    rng = np.random.default_rng(SEED)
    reported = rng.gamma(REPORTED + 0.5, size=DRAWS)
    chance = _Chance(drawn(DRAWS, rng), rng.uniform(*FREE_MPS2, DRAWS), rng.uniform(*SPREAD, DRAWS), rng.random(DRAWS))
    fixed = _fixed()
    values, draws = dict.fromkeys(KINDS, 0.0), {kind: np.zeros(DRAWS) for kind in KINDS}
    for group, cases in measured.items():
        meets, drawn_meets = encounters(group, counted), drawn_encounters(group, counted, reported, rng)
        for weight, of in _scenarios(group, cases):
            for kind, part in _parts(of, fixed, None).items():
                values[kind] += meets * weight * float(part[0])
            for kind, part in _parts(of, chance, rng).items():
                draws[kind] += drawn_meets * weight * part
    return Risk(
        rates={kind: _interval(values[kind], draws[kind]) for kind in KINDS},
        groups=tuple(
            GroupRisk(group, encounters(group, counted), reported_crashes(group), len(cases), _ends(cases))
            for group, cases in measured.items()
        ),
        unmeasured=tuple(group for group in PER_1E9_MILES if group not in measured),
        left_out=len(every) - len(known),
    )


def _interval(value: float, draws: NDArray[np.float64]) -> Interval:
    """Return a rate with 95 % of its draws; from 0 on where nothing happened (Brown, Cai, DasGupta 2001, section 4.1)."""
    low, high = np.quantile(draws, [0.025, 0.975])
    return Interval(value, 0.0 if value == 0.0 else float(low), float(high))


class _Chance(NamedTuple):
    """Draws (N,) of what all scenarios share."""

    curves: Curves
    medians_mps2: NDArray[np.float64]
    spreads: NDArray[np.float64]
    unknown: NDArray[np.float64]  # part of the unknown cases that are crashes


def _fixed() -> _Chance:
    """Return the middle of everything; an unknown case counts as no crash there, and the interval shows it."""
    return _Chance(middle(), np.array([np.sqrt(np.prod(FREE_MPS2))]), np.array([np.mean(SPREAD)]), np.zeros(1))


def _ends(cases: Sequence[PlayedCase]) -> dict[str, int]:
    return {end: sum(case.end == end for case in cases) for end in (CRASH, DISENGAGEMENT, PASSED, UNKNOWN)}


def _scenarios(group: Group, cases: Sequence[PlayedCase]) -> list[tuple[float, list[PlayedCase]]]:
    """Return the cases of each scenario with its weight; the weights sum to 1."""
    found: dict[str, list[PlayedCase]] = defaultdict(list)
    for case in cases:
        found[case.counted.scenario].append(case)
    weights = scenario_weights(group, [case.counted for case in cases])
    total = sum(weights.values())
    return [(weights[name] / total, of) for name, of in found.items()]


def _parts(
    cases: Sequence[PlayedCase], chance: _Chance, rng: np.random.Generator | None
) -> dict[str, NDArray[np.float64]]:
    """Return the probability (N,) of each kind in one conflict of a scenario; without ``rng`` that of the counts."""
    ends, count = _ends(cases), len(cases)
    size = len(chance.unknown)

    def share(number: int) -> NDArray[np.float64]:
        if rng is None:
            return np.full(size, number / count)
        return rng.beta(number + 0.5, count - number + 0.5, size)

    crash = np.minimum(1.0, share(ends[CRASH]) + chance.unknown * (ends[UNKNOWN] / count))
    on_foot: NDArray[np.float64] = np.zeros(size)
    deaths: NDArray[np.float64] = np.zeros(size)
    hits = [case for case in cases if case.impact_mps is not None]
    supposed = [cases[0]._replace(impact_mps=SUPPOSED_MPS)] if rng is not None and not hits else []
    for case in hits or supposed:
        hurt = severe(case.impact_mps or 0.0, case.partner, chance.curves) / len(hits or supposed)
        if case.partner in (Partner.WALKER, Partner.CYCLIST):
            on_foot = on_foot + hurt
        else:
            deaths = deaths + hurt
    falls = sum(
        (share_that_falls(case.braking_mps2, chance.medians_mps2, chance.spreads) / count for case in cases),
        np.zeros(size),
    )
    return dict(zip(KINDS, (crash, crash * on_foot, crash * deaths, falls, share(ends[DISENGAGEMENT])), strict=True))
