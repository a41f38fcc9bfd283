"""Claims about events: infractions by number, the rest by letter, nothing twice."""

from dataclasses import replace

from basu.metrics.infraction import row_of
from basu.output.report.events import events
from fakes.drives import at, driven
from fakes.run_records import crashing, record


def test_infractions_are_numbered_in_their_order() -> None:
    found = events(record(crashing()).result)
    scored = [event for event in found if event.factor is not None]
    assert [event.anchor for event in scored] == ["infraction-1", "infraction-2", "infraction-3"]
    assert [event.kind for event in scored] == ["speeding", "stop_sign", "collision_static"]
    assert [event.factor for event in scored] == [0.8, 0.8, 0.65]


def test_what_is_not_scored_has_letters_and_is_reported_too() -> None:
    rest = [event for event in events(record(crashing()).result) if event.factor is None]
    assert [event.label for event in rest] == list("abcdefgh"[: len(rest)])
    assert "harsh_stop" in {event.kind for event in rest}
    assert [event.t_s for event in rest] == sorted(event.t_s for event in rest)


def test_a_clean_drive_has_none() -> None:
    assert events(record(driven(at(8.0, 25.0), limit_mps=11.0)).result) == ()


def test_letters_go_on_after_z() -> None:
    result = record(crashing()).result
    row = {**row_of(result.infractions[0]), "kind": "outside_lanes"}
    result = replace(result, metrics={**result.metrics, "passengers": None, "outside_lanes": {"events": [row] * 28}})
    labels = [event.label for event in events(result) if event.kind == "outside_lanes"]
    assert labels[-3:] == ["z", "aa", "ab"]
