"""Claims about storyboards for a player whose conditions stay true: each motion begins when it did in the rehearsal."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from basu.testing import Rehearsal
from basu_openscenario.exporting.case_export import ESMINI, SCENARIO_RUNNER, STEP_S, Exported
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario

Export = Callable[[str, str], tuple[Exported, Path]]

FRAME_S = 0.05
LATE_S = 0.15
"""Three frames: one until the act begins, one until the condition is looked at, one until the event begins."""
CASES = (
    "car_across_junction_1",  # a time to a place, a wait, a rest, and a vehicle that leaves the world
    "deer_at_dusk_1",  # an ego that was faster before than when the trigger holds
    "follow_leading_vehicle_1",  # a distance, and an end at the last point of the ego's way
    "pedestrian_turn_1",  # a trigger that counts after another one
    "pedestrian_turns_back_1",  # a trigger some seconds after another one
    "stop_and_go_1",  # one motion after the other
)


class LatchingCondition:
    """A condition as ScenarioRunner looks at it: after its delay, counted from the first look, and true for ever."""

    def __init__(self, element: ET.Element) -> None:
        self.delay_s = float(element.get("delay", "0"))
        (self.leaf,) = (
            one for one in element.iter() if one.tag.endswith("Condition") and one.tag not in {
                "Condition", "ByEntityCondition", "EntityCondition", "ByValueCondition",
            }
        )  # fmt: skip
        entity = element.find(".//EntityRef")
        self.entity = "" if entity is None else entity.get("entityRef", "")
        self.first_s: float | None = None
        self.far_m, self.moved_s, self.is_true = 0.0, 0.0, False

    def holds(self, now_s: float, world: "LatchingWorld") -> bool:
        """Note once and for ever whether the condition has been true."""
        if self.first_s is None:
            self.first_s, self.moved_s, self.far_m = now_s, now_s + self.delay_s, 0.0
        if not self.is_true and now_s >= self.first_s + self.delay_s:
            self.is_true = self._compared(now_s - self.first_s - self.delay_s, now_s, world)
        return self.is_true

    def _compared(self, since_s: float, now_s: float, world: "LatchingWorld") -> bool:
        kind, value = self.leaf.tag, self.leaf.get("value", "nan")
        if kind == "ParameterCondition":
            return world.parameters.get(self.leaf.get("parameterRef", "")) == float(value)
        if kind == "SimulationTimeCondition":
            return since_s > float(value)
        x_m, y_m, _, speed_mps = world.body(self.entity, now_s)
        if kind == "TraveledDistanceCondition":
            before = world.body(self.entity, now_s - FRAME_S)
            self.far_m += math.dist((x_m, y_m), before[:2]) if since_s > 0.0 else 0.0
            return self.far_m > float(value)
        if kind == "SpeedCondition":
            return (speed_mps > float(value)) == (self.leaf.get("rule") == "greaterThan")
        if kind == "StandStillCondition":
            self.moved_s = now_s if speed_mps > 0.1 else self.moved_s
            return now_s - self.moved_s > float(self.leaf.get("duration", "nan"))
        other = world.body(self.leaf.get("entityRef", ""), now_s)
        assert kind == "RelativeDistanceCondition", kind
        return math.dist((x_m, y_m), other[:2]) < float(value)


class LatchingWorld:
    """Actors that move as in a rehearsal, and the acts of a file over them."""

    def __init__(self, path: Path, played: Rehearsal) -> None:
        self.played, self.parameters = played, dict[str, float]()
        self.begun_s: dict[str, float] = {}
        self.over_s: dict[str, float] = {}
        self.acts = list(ET.parse(path).iter("Act"))
        self.conditions = {one: LatchingCondition(one) for act in self.acts for one in act.iter("Condition")}

    def body(self, name: str, now_s: float) -> tuple[float, ...]:
        """Return the state of an actor in the present frame of the rehearsal."""
        nth = min(max(round(now_s / STEP_S), 0), len(self.played.times_s) - 1)
        return tuple(float(value) for value in self.played.trails[name][nth])

    def holds(self, trigger: ET.Element | None, now_s: float) -> bool:
        """Return whether a trigger holds; all its conditions are looked at."""
        groups = [] if trigger is None else [
            [self.conditions[one].holds(now_s, self) for one in group] for group in trigger
        ]  # fmt: skip
        return any(all(group) for group in groups)

    def play(self, longest_s: float) -> float | None:
        """Play until all acts are over, and return when they are; None: not before ``longest_s``."""
        for now_s in np.arange(0.0, longest_s, FRAME_S):
            for act in self.acts:
                self._advance(act, float(now_s))
            if len(self.over_s) == len(self.acts):
                return float(now_s)
        return None

    def _advance(self, act: ET.Element, now_s: float) -> None:
        name = f"act {act.get('name')}"
        if name in self.over_s or not (name in self.begun_s or self.holds(act.find("StartTrigger"), now_s)):
            return
        self.begun_s.setdefault(name, now_s)
        for event in act.iter("Event"):
            if event.get("name", "") not in self.begun_s and self.holds(event.find("StartTrigger"), now_s):
                self.begun_s[event.get("name", "")] = now_s
                self.parameters |= dict(_set_by(event))
        if self.holds(act.find("StopTrigger"), now_s):
            self.over_s[name] = now_s


def _set_by(event: ET.Element) -> Iterator[tuple[str, float]]:
    for action in event.iter("ParameterAction"):
        (value,) = action.iter("SetAction")
        yield action.get("parameterRef", ""), float(value.get("value", "nan"))


@pytest.mark.parametrize("name", CASES)
def test_each_motion_begins_when_it_did_in_the_rehearsal(export_for: Export, name: str) -> None:
    made, path = export_for(name, SCENARIO_RUNNER)
    world = LatchingWorld(path, made.played)
    end_s = world.play(40.0)
    late_s = {one: world.begun_s.get(one, math.inf) - due_s for one, due_s in made.begins_s.items()}
    assert {one: value for one, value in late_s.items() if abs(value) > LATE_S} == {}
    assert end_s == pytest.approx(made.played.times_s[-1], abs=2 * LATE_S)


def test_a_case_in_which_nothing_happens_ends_with_its_time(export_for: Export) -> None:
    """All actors stand where they began, so that no trigger comes true before the time limit."""
    made, path = export_for("follow_leading_vehicle_1", SCENARIO_RUNNER)
    world = LatchingWorld(path, made.played)
    world.body = lambda name, now_s: (*made.played.trails[name][0, :3], 0.0)  # type: ignore[method-assign]
    assert world.play(30.0) is None
    assert world.play(200.0) is not None


@pytest.mark.parametrize("name", CASES)
def test_it_means_the_same_in_the_standard(export_for: Export, name: str, tmp_path: Path) -> None:
    """Before it is brought to version 1.0, the storyboard is played by a player that knows the standard."""
    made, _ = export_for(name, SCENARIO_RUNNER)
    road = export_for(name, ESMINI)[1].with_name("Linden.xodr")
    (tmp_path / road.name).write_bytes(road.read_bytes())
    path = tmp_path / "case.xosc"
    path.write_bytes(ET.tostring(made.scenario.get_element()))
    player = make_player(read_scenario(path))
    for _ in player.play(STEP_S, 60.0):
        pass
    begun_s = {
        change.path.rsplit("::", 1)[-1]: change.time_s
        for change in reversed(player.changes)
        if change.kind == "event" and change.state == "runningState"
    }
    late_s = {one: begun_s.get(one, math.inf) - due_s for one, due_s in made.begins_s.items()}
    assert {one: value for one, value in late_s.items() if abs(value) > LATE_S} == {}
    assert player.world.time_s == pytest.approx(made.played.times_s[-1], abs=LATE_S)
