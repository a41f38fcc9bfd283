"""Claims about notices during a run."""

from types import SimpleNamespace
from typing import Any

import pytest

from basu.metrics.score import infractions
from basu_window.hud.notices import FADE_S, LINES, Judge, Judgement, Notices
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


def test_notices_fade_and_the_oldest_make_room() -> None:
    notices = Notices()
    for number in range(LINES + 2):
        notices.add(str(number), now_s=10.0)
    assert [notice.text for notice, _ in notices.shown(10.0)] == [str(n) for n in range(2, LINES + 2)]
    assert [clear for _, clear in notices.shown(10.0 + FADE_S / 2)] == pytest.approx([0.5] * LINES)
    assert notices.shown(10.0 + FADE_S) == []


def test_each_infraction_is_reported_once_with_its_figures() -> None:
    notices = Notices()
    judge = Judge(metrics(driven(at(10.0, 5.0), collisions=[hit(50)])), notices)
    judge.refresh(0.0, anyway=True)
    judge.refresh(0.0, anyway=True)
    ((notice, _),) = notices.shown(0.0)
    assert notice.bad
    assert notice.text.startswith("collision static: hit static.poles at 10.00 m/s")
    assert judge.latest.tally() == ["1 x collision static"]
    assert judge.latest.impulses(99)[-50] == pytest.approx(100.0)


def test_it_is_judged_now_and_then_and_at_the_end() -> None:
    recorded = metrics(driven(at(10.0, 1.0)))
    judge = Judge(recorded, Notices())
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
