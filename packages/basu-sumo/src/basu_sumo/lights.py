"""Lights both ways: the simulator's heads and SUMO's links, paired by the signal that both name."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

import carla

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu_sumo.link import Link

LETTERS = {carla.TrafficLightState.Red: "r", carla.TrafficLightState.Yellow: "y", carla.TrafficLightState.Green: "G"}
GREEN, YELLOW = "Ggs", "yYu"


class Lights:
    """The paired lights. ``pairs`` counts the heads that SUMO's network names."""

    def __init__(self, link: Link, lights: Iterable[carla.TrafficLight]) -> None:
        """Pair the heads with the links of their ``linkSignalID``."""
        self._link = link
        self._heads = {light.get_opendrive_id(): light for light in lights}
        self._links: dict[str, dict[int, str]] = {}  # by SUMO's light: signal of each link
        self._phases: dict[str, list[str]] = {}
        self._shown: dict[str, Any] = {}
        self._seen: list[carla.TrafficLightState] = []  # of the heads, when SUMO's links were last set
        api = link.api.trafficlight
        with link.answering("naming its lights"):
            for light in sorted(api.getIDList()):
                count = len(api.getRedYellowGreenState(light))
                named = {nth: api.getParameter(light, f"linkSignalID:{nth}") for nth in range(count)}
                self._links[light] = {nth: signal for nth, signal in named.items() if signal in self._heads}
                program = api.getProgram(light)
                logics = [each for each in api.getAllProgramLogics(light) if each.programID == program]
                self._phases[light] = [phase.state for logic in logics for phase in logic.phases]
        self.pairs = len({signal for links in self._links.values() for signal in links.values()})

    def to_sumo(self) -> None:
        """Let SUMO's links show what the simulator's heads show."""
        states = [head.get_state() for head in self._heads.values()]
        if states == self._seen:
            return
        self._seen = states
        colours = dict(zip(self._heads, states, strict=True))
        for light, links in self._links.items():
            wanted = tuple(LETTERS.get(colours[signal], "r") for signal in links.values())
            if links and self._shown.get(light) != wanted:
                self._shown[light] = wanted
                with self._link.answering("setting a light"):
                    self._link.api.trafficlight.setRedYellowGreenState(light, self._state(light, links, wanted))

    def _state(self, light: str, links: dict[int, str], wanted: tuple[str, ...]) -> str:
        """Return the phase of SUMO's program that looks like this, with its crossings; else the links alone."""
        phases = self._phases[light]
        for phase in phases:
            if all(_letter(phase[nth]) == letter for nth, letter in zip(links, wanted, strict=True)):
                return phase
        state = ["r"] * (len(phases[0]) if phases else max(links) + 1)
        for nth, letter in zip(links, wanted, strict=True):
            state[nth] = letter if letter != "G" else _own_green(phases, nth)
        return "".join(state)

    def to_carla(self) -> None:
        """Let the simulator's heads show what SUMO's links show."""
        states: dict[str, list[str]] = defaultdict(list)
        with self._link.answering("reading its lights"):
            for light, links in self._links.items():
                state = self._link.api.trafficlight.getRedYellowGreenState(light) if links else ""
                for nth, signal in links.items():
                    states[signal].append(state[nth])
        for signal, letters in states.items():
            colour = _colour(letters)
            if self._shown.get(signal) != colour:
                self._shown[signal] = colour
                self._heads[signal].set_state(colour)


def _letter(state: str) -> str:
    return "G" if state in GREEN else "y" if state in YELLOW else "r"


def _own_green(phases: list[str], nth: int) -> str:
    """Return whether a link is green with or without the right of way, as in SUMO's own program."""
    return next((phase[nth] for phase in phases if phase[nth] in GREEN), "g")


def _colour(letters: list[str]) -> carla.TrafficLightState:
    """Return what a head shows when its links show these letters: green where any of them is."""
    seen = {_letter(letter) for letter in letters}
    if "G" in seen:
        return carla.TrafficLightState.Green
    return carla.TrafficLightState.Yellow if "y" in seen else carla.TrafficLightState.Red
