"""Claims about the judgement of a drive while it lasts."""

from types import SimpleNamespace
from typing import Any

import pytest

from basu.metrics.score import infractions
from basu_window.browser.judge import Judge, Judgement
from fakes.drives import at, driven, hit


def metrics(history: Any) -> Any:
    """A manager that has recorded ``history``; ``asked`` counts."""
    asked: list[int] = []

    def found() -> Any:
        asked.append(1)
        return infractions(history)

    return SimpleNamespace(
        asked=asked,
        ticks=len(history.frames),
        infractions_so_far=found,
        scores_so_far=lambda: None,
        contacts_since=lambda first: tuple(event for event in history.collisions if event.tick >= first),
    )


def test_infractions_and_impulses_are_those_of_the_record() -> None:
    judge = Judge(metrics(driven(at(10.0, 5.0), collisions=[hit(50)])))
    judge.refresh(0.0, anyway=True)
    assert [evidence.kind.value for evidence in judge.latest.found] == ["collision_static"]
    assert judge.latest.tally() == ["1 x collision static"]
    assert judge.latest.impulses(99)[-50] == pytest.approx(100.0)


def test_it_is_judged_now_and_then_and_at_the_end() -> None:
    recorded = metrics(driven(at(10.0, 1.0)))
    judge = Judge(recorded)
    later_s = 1e9
    for now_s in (later_s, later_s + 0.01, later_s + 0.02):
        judge.refresh(now_s)
    assert len(recorded.asked) == 1
    judge.refresh(later_s + 0.03, anyway=True)
    assert len(recorded.asked) == 2


def test_the_graph_ends_with_this_tick() -> None:
    impulses = Judgement(contacts=((100, 5.0), (299, 7.0), (99, 1.0))).impulses(299)
    assert impulses[-1] == 7.0
    assert impulses[0] == 5.0
    assert impulses.sum() == 12.0
