"""Claims about lights both ways, with heads and links that only record the calls they receive."""

import contextlib
from types import SimpleNamespace
from typing import Any

import carla

from basu_sumo.lights import Lights

RED, YELLOW, GREEN = carla.TrafficLightState.Red, carla.TrafficLightState.Yellow, carla.TrafficLightState.Green


class Head:
    def __init__(self, signal: str, state: carla.TrafficLightState) -> None:
        self._signal, self.state = signal, state

    def get_opendrive_id(self) -> str:
        return self._signal

    def get_state(self) -> carla.TrafficLightState:
        return self.state

    def set_state(self, state: carla.TrafficLightState) -> None:
        self.state = state


class TrafficLights:
    """SUMO's domain: one light of two heads with two links each, and a crossing that no head governs."""

    def __init__(self) -> None:
        self.state = "rrrrr"
        self.changes = 0

    def getIDList(self) -> list[str]:  # noqa: N802 - SUMO's name
        return ["j"]

    def getRedYellowGreenState(self, _light: str) -> str:  # noqa: N802 - SUMO's name
        return self.state

    def setRedYellowGreenState(self, _light: str, state: str) -> None:  # noqa: N802 - SUMO's name
        self.state = state
        self.changes += 1

    def getParameter(self, _light: str, key: str) -> str:  # noqa: N802 - SUMO's name
        return {"linkSignalID:0": "2", "linkSignalID:1": "2", "linkSignalID:2": "3", "linkSignalID:3": "3"}.get(key, "")

    def getProgram(self, _light: str) -> str:  # noqa: N802 - SUMO's name
        return "server"

    def getAllProgramLogics(self, _light: str) -> list[Any]:  # noqa: N802 - SUMO's name
        states = ("GgrrG", "yyrrr", "rrrrr", "rrGgr", "rryyr", "rrrrr")
        return [SimpleNamespace(programID="server", phases=[SimpleNamespace(state=state) for state in states])]


def joined(*heads: Head) -> tuple[Lights, TrafficLights]:
    api = TrafficLights()
    link: Any = SimpleNamespace(api=SimpleNamespace(trafficlight=api), answering=lambda _what: contextlib.nullcontext())
    return Lights(link, heads), api  # type: ignore[arg-type]


def test_sumo_s_links_follow_the_heads_with_right_of_way_and_crossings() -> None:
    first, second = Head("2", GREEN), Head("3", RED)
    lights, api = joined(first, second)
    assert lights.pairs == 2
    lights.to_sumo()
    assert api.state == "GgrrG"
    lights.to_sumo()
    assert api.changes == 1, "what has not changed is not set again"
    first.state = YELLOW
    lights.to_sumo()
    assert api.state == "yyrrr"


def test_a_state_that_no_phase_has_is_shown_link_by_link() -> None:
    lights, api = joined(Head("2", GREEN), Head("3", GREEN))
    lights.to_sumo()
    assert api.state == "GgGgr"


def test_the_heads_follow_sumo_s_links() -> None:
    first, second = Head("2", RED), Head("3", RED)
    lights, api = joined(first, second)
    for state, wanted in (("GgrrG", (GREEN, RED)), ("rryyr", (RED, YELLOW)), ("rrrsr", (RED, GREEN))):
        api.state = state
        lights.to_carla()
        assert (first.state, second.state) == wanted


def test_a_head_that_the_network_does_not_name_is_left_alone() -> None:
    other = Head("99", YELLOW)
    lights, api = joined(other)
    assert lights.pairs == 0
    api.state = "GgrrG"
    lights.to_carla()
    lights.to_sumo()
    assert other.state == YELLOW
    assert api.changes == 0
