"""Claims about a case's picture: it shows the moment that was judged, is small, quick, and the same each time."""

import re
import time
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from shapely import affinity, box

from basu.metrics.boxes import other_boxes, own_boxes
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX
from basu.output.report.scenarios.drawing.encounter import contacts_of, encounter_of, span_of
from basu.output.report.scenarios.drawing.picture import case_picture
from basu.records.history import Collision, History
from fakes.scenario_documents import STREETS, WALKER, case_result, crossing, failed


def parts(picture: str, style: str) -> list[ET.Element]:
    return [part for part in ET.fromstring(picture).iter() if style in part.get("class", "").split()]


def said(picture: str) -> list[str]:
    return [part.text or "" for part in ET.fromstring(picture).iter() if part.tag.endswith("}text")]


def unjudged(**changes: Any) -> dict[str, Any]:
    return case_result(judgements=[], things=[], **changes)


def test_the_moment_that_was_judged_is_the_one_that_is_shown() -> None:
    result = case_result()
    met = encounter_of(result, crossing(), span_of(result, crossing()))
    assert met is not None
    assert (met.tick, met.other, met.distance_m) == (162, "walker", 1.2)
    assert "1.20 m to walker at 8.1 s" in said(case_picture(result, crossing(), STREETS))


def test_without_a_judgement_the_least_distance_of_the_record_is_found_as_the_obvious_search_finds_it() -> None:
    history, result = crossing(), unjudged(phases_s={"setup": 0.0})
    met = encounter_of(result, history, span_of(result, history))
    assert met is not None
    own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)

    def shape(row: Any) -> Any:
        upright = box(row[0] - row[3], row[1] - row[4], row[0] + row[3], row[1] + row[4])
        return affinity.rotate(upright, row[2], use_radians=True)

    obvious = [shape(a).distance(shape(b)) for a, b in zip(own, others, strict=True)]
    assert met.distance_m == pytest.approx(min(obvious), abs=1e-9)
    assert met.tick == int(np.argmin(obvious))
    assert np.hypot(met.own_m[0] - met.theirs_m[0], met.own_m[1] - met.theirs_m[1]) == pytest.approx(min(obvious))


def test_a_contact_is_marked_where_the_boxes_met() -> None:
    history = crossing(brakes=False)
    (contact,) = contacts_of(failed(), history, span_of(failed(), history))
    assert contact.other == "walker"
    tick = history.collisions[0].tick
    assert abs(contact.at_m[0] - 50.0) < 0.3  # where the walker is
    assert 0.5 < contact.at_m[1] < 3.0
    picture = case_picture(failed(), history, STREETS)
    assert f"hits walker at {tick * 0.05:.1f} s" in said(picture)
    assert parts(picture, "hit")


def test_scenery_that_was_hit_lies_where_the_impulse_came_from() -> None:
    tree = Collision(tick=20, other_id=0, other_type="static.vegetation", impulse_ns=(0.0, -50.0, 0.0))
    history = replace(crossing(), collisions=(tree,))
    (contact,) = contacts_of(case_result(), history, span_of(case_result(), history))
    assert contact.at_m[1] == pytest.approx(1.75 + 1.0)  # pushed north: the tree is at the right side, south


def test_of_a_longer_run_only_the_scenarios_own_time_is_looked_at() -> None:
    result = unjudged(phases_s={"setup": 2.0, "trigger": 2.0, "conflict": 4.0, "end": 6.0})
    span = span_of(result, crossing())
    assert span == (40, 120)
    met = encounter_of(result, crossing(), span)
    assert met is not None
    assert met.tick <= 120


def test_one_that_met_no_actor_has_a_picture_too() -> None:
    result = unjudged(actors=[])
    history = crossing()
    alone = replace(history, others=history.others[:0])
    assert "no actor was near" in case_picture(result, alone, [])


@pytest.mark.parametrize("name", ["x_m", "y_m", "velocity_x_mps"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_a_simulator_that_lost_the_vehicle_does_not_cost_the_picture(name: str, value: float) -> None:
    history = crossing()
    history.frames[name][150:160] = value
    with np.errstate(all="ignore"):
        picture = case_picture(case_result(), history, STREETS)
    ET.fromstring(picture)
    assert "nan" not in re.sub("<style>.*</style>", "", picture, flags=re.DOTALL)


def test_a_record_of_one_tick_has_a_picture() -> None:
    history = crossing()
    short = replace(history, frames=history.frames[:1], others=history.others[:1])
    ET.fromstring(case_picture(unjudged(phases_s={}), short, STREETS))


def test_words_of_others_cannot_break_it() -> None:
    hostile = "</svg><script>alert(1)</script>\x00"
    roles = [{"id": WALKER, "role": hostile, "type": "walker.pedestrian.0001"}]
    picture = case_picture(unjudged(agent=hostile, actors=roles), crossing(), STREETS)
    assert not [part for part in ET.fromstring(picture).iter() if part.tag.endswith("script")]


def test_the_trail_tells_speed_by_shades_that_grow_lighter() -> None:
    style = ET.fromstring(case_picture(case_result(), crossing(), STREETS))[0].text or ""
    shades = [re.search(rf"\.v{band} {{ stroke: #(..)(..)(..)", style) for band in range(6)]
    light = [sum(w * int(shade[n], 16) for w, n in ((0.21, 1), (0.72, 2), (0.07, 3))) for shade in shades if shade]
    assert len(light) == 6
    assert light == sorted(light)


def test_words_lie_within_the_picture_and_not_on_each_other() -> None:
    for result, history in ((case_result(), crossing()), (failed(), crossing(brakes=False))):
        picture = case_picture(result, history, STREETS)
        placed = [p for p in parts(picture, "halo") if p.get("text-anchor") is None and p.get("x") != "14"]
        spans = [(float(p.get("x", 0)), float(p.get("y", 0)), len(p.text or "") * 6.0) for p in placed]
        assert len(spans) > 5
        for x, y, width in spans:
            assert x >= 0.0
            assert x + width <= WIDTH_PX + 1.0
            others = [other for other in spans if other != (x, y, width) and abs(other[1] - y) < 9.0]
            assert not [o for o in others if x < o[0] + o[2] and o[0] < x + width]


def test_a_minute_of_driving_is_a_small_picture() -> None:
    history = crossing(seconds=60.0)
    assert len(case_picture(case_result(), history, STREETS)) < 20_000


def test_it_is_quick() -> None:
    history: History = crossing()
    case_picture(case_result(), history, STREETS)  # warm
    took_s = []
    for _ in range(5):
        began_s = time.process_time()
        case_picture(case_result(), history, STREETS)
        took_s.append(time.process_time() - began_s)
    assert min(took_s) < 0.05


def test_the_same_case_gives_the_same_bytes() -> None:
    assert case_picture(case_result(), crossing(), STREETS) == case_picture(case_result(), crossing(), STREETS)
