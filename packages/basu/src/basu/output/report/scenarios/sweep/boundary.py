"""The rule of one parameter that best separates failed from passed cases: threshold, range or options, in sentences.

Of all thresholds and ranges between neighbouring values, the one with the table of counts that is the least likely by
chance: Fisher's exact test, one-sided, its probability multiplied by the number of rules that were tried (Bonferroni),
so that a range has to be worth more than a threshold, and noise finds no rule.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.output.report.scenarios.sweep.failure_rates import best_pair, neighbours_of
from basu.output.report.scenarios.sweep.study import studies

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from basu.output.report.scenarios.sweep.failure_rates import ParameterPair
    from basu.output.report.scenarios.sweep.study import Axis, Study


BY_CHANCE = 0.05  # a rule more likely than this by chance is none
MOST_CUTS = 200  # that ranges lie between; among more of them, these are spread evenly over the cases
MOST_OPTIONS = 12  # of a choice; with more of them no rule is looked for
MOST_DIGITS = 6
EXACT = 12  # rules of a kind with a computed chance: those with the greatest information gain
KINDS = 2  # thresholds and ranges


class Rule(NamedTuple):
    """Where the cases that fail lie along one parameter."""

    axis: Axis
    low: float  # fails above this: -inf for "below high"
    high: float  # fails below this: inf for "above low"
    options: tuple[str, ...]  # of a choice: with these it fails
    inside: NDArray[np.bool_]  # (N,) the cases it says will fail
    failed_inside: int
    failed_outside: int
    log_chance: float  # of such counts without any rule, after Bonferroni

    @property
    def is_sure(self) -> bool:
        """Whether chance is no explanation."""
        return self.log_chance < math.log(BY_CHANCE)

    def words(self) -> str:
        """Return where it fails, as a condition."""
        unit = f" {self.axis.unit}" if self.axis.unit and not self.axis.options else ""
        return f"{self.axis.name} {self.condition()}{unit}"

    def condition(self) -> str:
        """Return the same without name and unit."""
        if self.axis.options:
            return f"is {' or '.join(self.options)}"
        if self.low == -math.inf:
            return f"< {self.high:g}"
        if self.high == math.inf:
            return f"> {self.low:g}"
        return f"is {self.low:g} to {self.high:g}"


def best_rule(axis: Axis, failed: NDArray[np.bool_], among: NDArray[np.bool_] | None = None) -> Rule | None:
    """Return the best rule of a parameter over the cases ``among``; None where there is none to try."""
    used = np.ones(len(failed), dtype=np.bool_) if among is None else among
    rules = _of_options(axis, failed, used) if axis.options else _of_numbers(axis, failed, used)
    return min(rules, key=lambda rule: rule.log_chance, default=None)


def best_of(axes: Iterable[Axis], failed: NDArray[np.bool_], among: NDArray[np.bool_] | None = None) -> Rule | None:
    """Return the best rule of all parameters that chance does not explain, the number of parameters counted."""
    used = list(axes)
    rules = [rule for axis in used if (rule := best_rule(axis, failed, among)) is not None]
    rules = [rule._replace(log_chance=rule.log_chance + math.log(len(used))) for rule in rules]
    return min((rule for rule in rules if rule.is_sure), key=lambda rule: rule.log_chance, default=None)


def _of_numbers(axis: Axis, failed: NDArray[np.bool_], used: NDArray[np.bool_]) -> list[Rule]:
    """Return the best threshold and the best range, each against all of its kind."""
    values, order = np.sort(axis.values[used]), np.argsort(axis.values[used], kind="stable")
    fails = np.concatenate([[0], np.cumsum(failed[used][order])])
    cuts, total = np.flatnonzero(np.diff(values) > 0.0) + 1, len(values)
    if len(cuts) == 0:
        return []
    inner = cuts[np.unique(np.linspace(0, len(cuts) - 1, MOST_CUTS).round().astype(np.int64))]
    begins, ends = np.triu_indices(len(inner), 1)
    first = np.concatenate([np.zeros_like(cuts), cuts, inner[begins]])
    last = np.concatenate([cuts, np.full_like(cuts, total), inner[ends]])
    hits, drawn = fails[last] - fails[first], last - first
    gains = _gains(hits, drawn, int(fails[-1]), total)
    is_threshold = (first == 0) | (last == total)
    found = []
    for kind in (is_threshold, ~is_threshold):
        if kind.any():
            hopeful = np.flatnonzero(kind)[np.argsort(-gains[kind], kind="stable")[:EXACT]]
            chances = _log_chances(hits[hopeful], drawn[hopeful], int(fails[-1]), total)
            best = int(hopeful[np.argmin(chances)])
            begin, end = int(first[best]), int(last[best])
            low = -math.inf if begin == 0 else between(float(values[begin - 1]), float(values[begin]))
            high = math.inf if end == total else between(float(values[end - 1]), float(values[end]))
            inside = used & (axis.values > low) & (axis.values < high)
            chance = float(chances.min()) + math.log(KINDS * int(kind.sum()))
            found.append(_rule(axis, low, high, (), inside, failed, used, chance))
    return found


def _of_options(axis: Axis, failed: NDArray[np.bool_], used: NDArray[np.bool_]) -> list[Rule]:
    """Options in the order of their share of failures: the first so many of them against the rest."""
    if len(axis.options) > MOST_OPTIONS:
        return []
    counts = [(int((used & (axis.values == number)).sum()), number) for number in range(len(axis.options))]
    shares = {number: float(failed[used & (axis.values == number)].mean()) for count, number in counts if count > 0}
    ordered = sorted(shares, key=lambda number: (-shares[number], number))
    tried = 2 ** (len(ordered) - 1) - 1
    found = []
    for count in range(1, len(ordered)):
        chosen = sorted(ordered[:count])
        inside = used & np.isin(axis.values, chosen)
        chance = _log_chances(
            np.array([(failed & inside).sum()]), np.array([inside.sum()]), int((failed & used).sum()), int(used.sum())
        )
        options = tuple(axis.options[number] for number in chosen)
        found.append(_rule(axis, math.nan, math.nan, options, inside, failed, used, float(chance[0]) + math.log(tried)))
    return found


def _rule(
    axis: Axis,
    low: float,
    high: float,
    options: tuple[str, ...],
    inside: NDArray[np.bool_],
    failed: NDArray[np.bool_],
    used: NDArray[np.bool_],
    log_chance: float,
) -> Rule:
    """Return a rule with the failures inside and outside of it."""
    return Rule(
        axis,
        low,
        high,
        options,
        inside,
        int((failed & inside).sum()),
        int((failed & used & ~inside).sum()),
        log_chance,
    )


def _gains(hits: NDArray[np.int64], drawn: NDArray[np.int64], failed: int, total: int) -> NDArray[np.float64]:
    """(K,) bits that knowing a side tells about the verdict; negative where the failures lie on the other side."""

    def entropy(some: NDArray[np.float64]) -> NDArray[np.float64]:
        held = np.clip(some, 1e-12, 1.0 - 1e-12)
        bits: NDArray[np.float64] = -held * np.log2(held) - (1.0 - held) * np.log2(1.0 - held)
        return bits

    inside, outside = hits / drawn, (failed - hits) / np.maximum(total - drawn, 1)
    left = (drawn * entropy(inside) + (total - drawn) * entropy(outside)) / total
    gain: NDArray[np.float64] = entropy(np.array(failed / total)) - left
    return np.where(inside >= outside, gain, -gain)


def _log_chances(hits: NDArray[np.int64], drawn: NDArray[np.int64], failed: int, total: int) -> NDArray[np.float64]:
    """Return the log probability (K,) that each rule's cases, if chosen at random, hold at least ``hits`` failures."""
    from scipy.stats import hypergeom  # noqa: PLC0415 - 0.8 s, which a matrix without a sweep does without

    chances: NDArray[np.float64] = hypergeom.logsf(hits - 1, total, failed, drawn)
    return np.minimum(chances, 0.0)


def between(low: float, high: float) -> float:
    """Return the shortest number between two."""
    middle = (low + high) / 2.0
    for digits in range(MOST_DIGITS):
        candidate = round(middle, digits)
        if low < candidate < high:
            return candidate
    return middle


class FailureBoundary(NamedTuple):
    """What is known about it."""

    study: Study
    rule: Rule | None  # of one parameter, if any tells the failures
    within: Rule | None  # a second one, of the cases that the first says will fail
    each: list[Rule]  # the best of every parameter, whether chance explains it or not
    pair: ParameterPair | None  # the two parameters of the map


def boundary_of(study: Study) -> FailureBoundary:
    """Look for it."""
    each = [rule for axis in study.axes if (rule := best_rule(axis, study.failed)) is not None]
    if not study.is_mixed:
        return FailureBoundary(study, None, None, each, best_pair(study))
    rule = best_of(study.axes, study.failed)
    within = None
    if rule is not None:
        rest = [axis for axis in study.axes if axis.name != rule.axis.name]
        within = best_of(rest, study.failed, rule.inside)
    return FailureBoundary(study, rule, within, each, best_pair(study))


def boundary(matrix: dict[str, Any]) -> list[str]:
    """Sentences about every scenario that was sampled and every agent; none where nothing was."""
    return [
        f"{study.agent} in {study.scenario}: {sentence}"
        for study in studies(matrix)
        for sentence in sentences(boundary_of(study))
    ]


def sentences(found: FailureBoundary) -> list[str]:
    """Return what is known, in sentences that begin small, so that they can follow a name."""
    study = found.study
    count, failed = len(study.failed), int(study.failed.sum())
    left = [f"{study.absent} more cases were not exercised and are left out."] if study.absent else []
    if failed == 0:
        return [f"passes all {count} cases.", *left]
    if failed == count:
        return [f"fails all {count} cases.", *left]
    lines = [f"fails {failed} of {count} cases.", *left]
    if found.rule is None:
        lines.append("no single parameter tells which: any such rule could be chance (Fisher's exact test, 5 %).")
    else:
        lines.append(_one(found.rule, count - int(found.rule.inside.sum())))
    if found.rule is not None and found.within is not None:
        lines.append(_both(found.rule, found.within, study))
    if found.pair is not None and found.pair.tells:
        lines.append(_pair_in_words(found.pair))
    return lines


def _one(rule: Rule, outside: int) -> str:
    """Return a rule of one parameter with its counts."""
    inside = int(rule.inside.sum())
    if 2 * rule.failed_inside < inside:
        return (
            f"fails more often where {rule.words()} ({rule.failed_inside} of {inside}) "
            f"than elsewhere ({rule.failed_outside} of {outside})."
        )
    passed = outside - rule.failed_outside
    return f"fails where {rule.words()} ({rule.failed_inside} of {inside}), passes elsewhere ({passed} of {outside})."


def _both(rule: Rule, within: Rule, study: Study) -> str:
    """Two rules together."""
    inside = int(within.inside.sum())
    outside = len(study.failed) - inside
    passed = int((~study.failed & ~within.inside).sum())
    return (
        f"more narrowly, where {rule.words()} and {within.words()} "
        f"({within.failed_inside} of {inside} fail, elsewhere {passed} of {outside} pass)."
    )


def _pair_in_words(pair: ParameterPair) -> str:
    """Return the map's two parameters, and how far they can be trusted."""
    near = neighbours_of(pair.used)
    return (
        f"of all pairs, {pair.x.name} and {pair.y.name} predict best: {pair.right} of {pair.used} verdicts, each "
        f"from the {near} or so other cases nearest in them (the commoner verdict alone, {pair.commoner})."
    )
