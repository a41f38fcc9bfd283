"""Claims about findings: infractions by number, the rest by letter, nothing twice."""

from basu.output.report.findings import findings
from fakes.drives import at, driven
from fakes.run_records import crashing, record


def test_infractions_are_numbered_in_their_order() -> None:
    found = findings(record(crashing()).result)
    scored = [finding for finding in found if finding.factor is not None]
    assert [finding.anchor for finding in scored] == ["infraction-1", "infraction-2", "infraction-3"]
    assert [finding.kind for finding in scored] == ["speeding", "stop_sign", "collision_static"]
    assert [finding.factor for finding in scored] == [0.8, 0.8, 0.65]


def test_what_is_not_scored_has_letters_and_is_told_too() -> None:
    rest = [finding for finding in findings(record(crashing()).result) if finding.factor is None]
    assert [finding.label for finding in rest] == list("abcdefgh"[: len(rest)])
    assert "harsh_stop" in {finding.kind for finding in rest}
    assert [finding.t_s for finding in rest] == sorted(finding.t_s for finding in rest)


def test_a_clean_drive_has_none() -> None:
    assert findings(record(driven(at(8.0, 25.0), limit_mps=11.0)).result) == ()


def test_letters_go_on_after_z() -> None:
    document = record(crashing()).result
    event = {**document["infractions"][0], "kind": "outside_lanes"}
    document = {**document, "passengers": None, "outside_lanes": {"events": [event] * 28}}
    labels = [finding.label for finding in findings(document) if finding.kind == "outside_lanes"]
    assert labels[-3:] == ["z", "aa", "ab"]
