"""Expected crashes, injuries, falls and disengagements for a million miles, from the cases that an agent played.

The sum over the groups of conflicts for a million miles (`exposure`) times the probability that a conflict of the group
ends so. A group's probability is that of its scenarios, weighted by the frequency of the pre-crash scenarios that they
stand for. Each case ends in one way:

- *crash*: the ego touched something.
- *disengagement*: no contact, and a person would have had to take over. The drive was not completed, the agent broke
  down, or the case was failed. A driver that stands still or creeps ends here.
- *passed*.
- *unknown*: the drive was completed and the conflict did not come about. Each such case may be a crash, so it widens
  the interval by all of itself.

An interval has draws of everything uncertain. These are the conflicts (behind a reported crash, or counted), the injury
curves, and the part of the unknown cases that are crashes (0 to 1, one for the whole agent). The probability of an end
is that of Clopper and Pearson at the effective number of cases, as in `basu.intervals.weighted`. The ends of the
interval have draws of the beta distributions of its two ends. Cases of a campaign's estimate have importance weights,
and their effective number follows from the variance of the weighted rate (`_Met.trials`). Where no case had an impact,
the draws suppose impacts at the shuttle's highest speed.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from basu.intervals import Interval
from basu.metrics.passengers.balance import FREE_MPS2, SPREAD, share_that_falls
from basu.records.partners import Partner
from basu.scenarios.nhtsa import TABLE_1_1, Group
from basu.scenarios.risk.exposure import REPORTED, Exposure, drawn_encounters, encounters, reported_crashes
from basu.scenarios.risk.injuries import ON_FOOT, Curves, drawn_curves, middle, severe
from basu.scenarios.shares import scenario_weights
from basu.scenarios.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from basu.scenarios.shares import CountedCase

Draws: TypeAlias = "NDArray[np.float64]"  # (N,)
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
    weight: float = 1.0  # importance weight of a drive of a campaign's estimate
    plain: float = 1.0  # share of plain drives in the mixture from which it comes: no weight is above its inverse

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
    by_group = {group: [case for case in known if case.counted.group is group] for group in TABLE_1_1}
    measured = {group: cases for group, cases in by_group.items() if cases}
    rng = np.random.default_rng(SEED)
    reported = rng.gamma(REPORTED + 0.5, size=DRAWS)
    met = [
        _Met(weight * encounters(group, counted), weight * drawn, of)
        for group, cases in measured.items()
        for drawn in [drawn_encounters(group, counted, reported, rng)]
        for weight, of in _scenarios(group, cases)
    ]
    chance = _Chance(drawn_curves(DRAWS, rng), rng.uniform(*FREE_MPS2, DRAWS), rng.uniform(*SPREAD, DRAWS))
    on_foot = [each for each in met if each.cases[0].partner in ON_FOOT]
    others = [each for each in met if each.cases[0].partner not in ON_FOOT]
    rates = (
        _rate(met, CRASH, rng),
        _rate(on_foot, CRASH, rng, chance.curves),
        _rate(others, CRASH, rng, chance.curves),
        _falls(met, chance),
        _rate(met, DISENGAGEMENT, rng),
    )
    return Risk(
        rates=dict(zip(KINDS, rates, strict=True)),
        groups=tuple(
            GroupRisk(group, encounters(group, counted), reported_crashes(group), len(cases), _ends(cases))
            for group, cases in measured.items()
        ),
        unmeasured=tuple(group for group in TABLE_1_1 if group not in measured),
        left_out=len(every) - len(known),
    )


class _Met(NamedTuple):
    """A scenario that is met in traffic."""

    conflicts: float  # for a million miles
    drawn: Draws  # of them
    cases: Sequence[PlayedCase]

    def share(self, end: str) -> float:
        """Return the part of its cases with an end, at most 1; each case counts with its weight."""
        return min(1.0, sum(case.weight for case in self.cases if case.end == end) / len(self.cases))

    def trials(self, end: str) -> float:
        """Return the number of cases without weights that would say as much about an end.

        With weights it is p (1 - p) / v, where v is the variance of the estimate (Owen 2013, "Monte Carlo theory,
        methods and examples", section 9.1). Without a case that ended so, plain drives alone count.
        """
        if all(case.weight == case.plain == 1.0 for case in self.cases):
            return float(len(self.cases))
        least = sum(case.plain for case in self.cases)
        terms = np.array([case.weight * (case.end == end) for case in self.cases])
        share, variance = self.share(end), float(terms.var()) / len(terms)
        return max(least, share * (1.0 - share) / variance) if variance > 0.0 else least


class _Chance(NamedTuple):
    """Draws (N,) of what all scenarios share."""

    curves: Curves
    medians_mps2: Draws
    spreads: Draws


def _rate(met: Sequence[_Met], end: str, rng: np.random.Generator, curves: Curves | None = None) -> Interval:
    """Return how often cases end so for a million miles, or how often that injures, by ``curves``."""
    conflicts = sum(each.conflicts for each in met)
    if not conflicts > 0.0:
        return Interval(0.0, 0.0, 0.0, 0)
    total = np.sum([each.drawn for each in met], axis=0)
    trials = conflicts**2 / sum(each.conflicts**2 / each.trials(end) for each in met)
    share = min(1.0, sum(each.conflicts * each.share(end) for each in met) / conflicts)
    hits = min(trials, trials * share)
    low = rng.beta(hits, trials - hits + 1.0, DRAWS) if hits > 0.0 else np.zeros(DRAWS)
    high = rng.beta(hits + 1.0, trials - hits, DRAWS) if hits < trials else np.ones(DRAWS)
    if end == CRASH:
        unknown = sum(each.conflicts * each.share(UNKNOWN) for each in met) / conflicts
        high = np.minimum(1.0, high + unknown * rng.random(DRAWS))
    hurt = np.ones(1) if curves is None else _hurt(met, middle())
    drawn_hurt = np.ones(DRAWS) if curves is None else _hurt(met, curves)
    return Interval(
        conflicts * share * float(hurt[0]),
        float(np.quantile(total * low * drawn_hurt, 0.025)),
        float(np.quantile(total * high * drawn_hurt, 0.975)),
    )


def _hurt(met: Sequence[_Met], curves: Curves) -> Draws:
    """Return the mean risk (N,) of a severe injury in a crash; in supposed crashes where there was none."""
    hits = [
        (case.weight * each.conflicts / len(each.cases), case.impact_mps, case.partner)
        for each in met
        for case in each.cases
        if case.impact_mps is not None
    ]
    hits = hits or [(each.conflicts, SUPPOSED_MPS, each.cases[0].partner) for each in met]
    found: Draws = np.zeros(len(curves.change))
    for weight, speed_mps, partner in hits:
        found = found + weight * severe(speed_mps, partner, curves)
    return found / sum(weight for weight, _, _ in hits)


def _falls(met: Sequence[_Met], chance: _Chance) -> Interval:
    """Return the falls of one standing passenger for a million miles: median, and interval of the draws."""
    draws: Draws = np.zeros(DRAWS)
    for each in met:
        for case in each.cases:
            fallen = share_that_falls(case.braking_mps2, chance.medians_mps2, chance.spreads)
            draws = draws + case.weight * each.drawn / len(each.cases) * fallen
    low, value, high = (float(end) for end in np.quantile(draws, [0.025, 0.5, 0.975]))
    return Interval(value, low, high)


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
