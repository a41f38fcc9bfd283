"""Claims about the film of a case: its key frames give every place of the record, and it is small."""

from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import pytest

from basu.metrics.boxes import other_boxes, own_boxes
from basu.output.report.scenarios.drawing.canvas import Canvas, canvas_for, what_matters
from basu.output.report.scenarios.drawing.encounter import story_of
from basu.output.report.scenarios.drawing.film import OFF_PX, OFF_RAD, film, key_frames
from basu.output.report.templates import html
from basu.records.history import History
from fakes.scenario_documents import case_result, crossing, failed

ROUNDED_PX = 0.06  # places are written with a digit after the point


def filmed(result: dict[str, Any], history: History) -> tuple[Element, Canvas]:
    story = story_of(result, history)
    canvas = canvas_for(what_matters(story))
    made = film(story, canvas)
    assert made is not None
    return made, canvas


def keys(part: Element) -> np.ndarray:
    return np.array([[float(value) for value in key.split()] for key in part.get("data-keys", "").split(";")])


def parts(made: Element, style: str) -> list[Element]:
    return [part for part in made if part.get("class") == style]


@pytest.mark.parametrize("style", ["own", "other"])
def test_between_key_frames_every_place_of_the_record_is_met(style: str) -> None:
    history = crossing()
    made, canvas = filmed(case_result(), history)
    (part,) = parts(made, style)
    found = keys(part)
    if style == "own":
        t_s, boxes = history.frames["t_s"], own_boxes(history.facts, history.frames)
    else:
        t_s, boxes = history.frames["t_s"][history.others["tick"]], other_boxes(history.facts, history.others)
    shown = (t_s >= found[0, 0]) & (t_s <= found[-1, 0])
    for column, true in ((1, canvas.at(boxes[:, 0], boxes[:, 1])[0]), (2, canvas.at(boxes[:, 0], boxes[:, 1])[1])):
        off_px = np.interp(t_s[shown], found[:, 0], found[:, column]) - true[shown]
        assert np.abs(off_px).max() <= OFF_PX + ROUNDED_PX
    off_deg = np.interp(t_s[shown], found[:, 0], found[:, 3]) - np.degrees(np.unwrap(boxes[shown, 2]))
    assert np.abs(off_deg).max() <= np.degrees(OFF_RAD) + 0.51


def test_straight_motion_needs_two_key_frames_and_a_corner_a_third() -> None:
    t_s = np.arange(0.0, 10.0, 0.05)
    straight = np.column_stack([8.0 * t_s, np.zeros_like(t_s), np.zeros_like(t_s)])
    assert key_frames(t_s, straight).tolist() == [0, len(t_s) - 1]
    corner = straight.copy()
    corner[100:, 1] = 8.0 * (t_s[100:] - t_s[100])
    assert 100 in key_frames(t_s, corner)
    assert len(key_frames(t_s, corner)) == 3


def test_a_contact_appears_at_its_moment_and_a_thing_goes_with_its_time() -> None:
    history = crossing(brakes=False)
    made, _ = filmed(failed(), history)
    touched = [part for part in made if part.tag == "g"]
    assert [float(part.get("data-from", "nan")) for part in touched] == [history.collisions[0].tick * 0.05]
    thing = {"name": "static.prop.bin", "x_m": 45.0, "y_m": 3.0, "yaw_rad": 0.0, "half_length_m": 0.5}
    there = {**thing, "half_width_m": 0.5, "from_s": 2.0, "until_s": 4.0}
    (drawn,) = parts(filmed(case_result(things=[there]), history)[0], "thing")
    assert (drawn.get("data-from"), drawn.get("data-until")) == ("2", "4")


def test_the_film_says_the_phase_and_the_speed_of_each_moment() -> None:
    history = crossing()
    made, _ = filmed(case_result(), history)
    begun_s = case_result()["phases_s"]["conflict"]
    assert f"{begun_s:g} conflict" in made.get("data-words", "").split(";")
    speeds = np.array([[float(value) for value in key.split()] for key in made.get("data-speed", "").split(";")])
    true_mps = np.interp(speeds[:, 0], history.frames["t_s"], history.speed_mps())
    assert np.abs(speeds[:, 1] - true_mps).max() <= 0.051


def test_a_film_is_small_and_the_same_each_time() -> None:
    first, again = (html(filmed(case_result(), crossing())[0]) for _ in range(2))
    assert first == again
    assert len(first) < 3_000
