"""Where an agent begins to fail, in sentences with counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.output.report.scenarios.sweep.neighbours import best_pair, neighbours_of
from basu.output.report.scenarios.sweep.rules import best_of, best_rule
from basu.output.report.scenarios.sweep.study import studies

if TYPE_CHECKING:
    from basu.output.report.scenarios.sweep.neighbours import Pair
    from basu.output.report.scenarios.sweep.rules import Rule
    from basu.output.report.scenarios.sweep.study import Study


class Boundary(NamedTuple):
    """What is known about it."""

    study: Study
    rule: Rule | None  # of one parameter, if any tells the failures
    within: Rule | None  # a second one, of the cases that the first says will fail
    each: list[Rule]  # the best of every parameter, whether chance explains it or not
    pair: Pair | None  # the two parameters of the map


def boundary_of(study: Study) -> Boundary:
    """Look for it."""
    each = [rule for axis in study.axes if (rule := best_rule(axis, study.failed)) is not None]
    if not study.is_mixed:
        return Boundary(study, None, None, each, best_pair(study))
    rule = best_of(study.axes, study.failed)
    within = None
    if rule is not None:
        rest = [axis for axis in study.axes if axis.name != rule.axis.name]
        within = best_of(rest, study.failed, rule.inside)
    return Boundary(study, rule, within, each, best_pair(study))


def boundary(matrix: dict[str, Any]) -> list[str]:
    """Sentences about every scenario that was sampled and every agent; none where nothing was."""
    return [
        f"{study.agent} in {study.scenario}: {sentence}"
        for study in studies(matrix)
        for sentence in sentences(boundary_of(study))
    ]


def sentences(found: Boundary) -> list[str]:
    """What is known, in sentences that begin small, so that they can follow a name."""
    study = found.study
    count, failed = len(study.failed), int(study.failed.sum())
    left = [f"{study.absent} more cases were not exercised and are left out."] if study.absent else []
    if failed == 0:
        return [f"passes all {count} cases.", *left]
    if failed == count:
        return [f"fails all {count} cases.", *left]
    told = [f"fails {failed} of {count} cases.", *left]
    if found.rule is None:
        told.append("no single parameter tells which: any such rule could be chance (Fisher's exact test, 5 %).")
    else:
        told.append(_one(found.rule, count - int(found.rule.inside.sum())))
    if found.rule is not None and found.within is not None:
        told.append(_both(found.rule, found.within, study))
    if found.pair is not None and found.pair.tells:
        told.append(_told_by(found.pair))
    return told


def _one(rule: Rule, outside: int) -> str:
    """A rule of one parameter with its counts."""
    inside = int(rule.inside.sum())
    if 2 * rule.failed_inside < inside:
        return (
            f"fails more often where {rule.told()} ({rule.failed_inside} of {inside}) "
            f"than elsewhere ({rule.failed_outside} of {outside})."
        )
    passed = outside - rule.failed_outside
    return f"fails where {rule.told()} ({rule.failed_inside} of {inside}), passes elsewhere ({passed} of {outside})."


def _both(rule: Rule, within: Rule, study: Study) -> str:
    """Two rules together."""
    inside = int(within.inside.sum())
    outside = len(study.failed) - inside
    passed = int((~study.failed & ~within.inside).sum())
    return (
        f"more narrowly, where {rule.told()} and {within.told()} "
        f"({within.failed_inside} of {inside} fail, elsewhere {passed} of {outside} pass)."
    )


def _told_by(pair: Pair) -> str:
    """The map's two parameters, and how far they can be trusted."""
    near = neighbours_of(pair.asked)
    return (
        f"of all pairs, {pair.x.name} and {pair.y.name} foretell best: {pair.right} of {pair.asked} verdicts, each "
        f"from the {near} or so other cases nearest in them (the commoner verdict alone, {pair.commoner})."
    )
