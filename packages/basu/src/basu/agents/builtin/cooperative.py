"""The cooperative agent: the behavioral one, with a radio by which shuttles keep apart, agree and warn each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.cooperation.headways import Headways
from basu.agents.builtin.cooperation.stop_order import StopOrder, StoppedVehicle, line_text
from basu.agents.builtin.cooperation.warnings import WarnedPeople, warnings_of
from basu.agents.builtin.rules.right_of_way import StopPhase
from basu.agents.builtin.rules.stopping_lines import ServicePhase, hold_at, is_resting_at
from basu.thresholds import IN_MOTION_MPS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import carla

    from basu.agents.builtin.driving.driver import BehavioralDriver
    from basu.agents.builtin.rules.right_of_way import StopSign
    from basu.agents.sight import Other
    from basu.routing import Route

RADIO = "COOPERATION"
SHORT_TICKS, LONG_TICKS = 4, 20  # between two texts of one kind: 0.2 s, and 1 s for departures
CROSSING_M = 15.0  # behind a line, until the junction is free
GAP_SHARE = 0.1  # of the length: the ends of a round are nearer; a second shuttle begins a little farther along it


class CooperativeAgent(BehavioralAgent):
    """Drives as ``behavioral``; what it hears adds people to see, lines to wait at and time at service stops."""

    def setup(self) -> None:
        """Begin a drive without messages from other vehicles."""
        super().setup()
        self.people, self.order = WarnedPeople(), StopOrder()
        self.headways = headways_of(self.seen_route)
        self._ticks = 0
        self._standing: tuple[StopSign, StoppedVehicle] | None = None
        self._held: set[int] = set()  # the service stops, by their place in the route, where the hold is decided
        self._left: set[int] = set()

    def sensors(self) -> list[dict[str, Any]]:
        """Return the radio; it hears beyond CARLA's usual 500 m where its power suffices."""
        return [{"type": "sensor.other.v2x_custom", "id": RADIO, "z": 3.0, "filter_distance": 2000.0}]

    def config(self) -> dict[str, str]:
        """The shuttle on its round."""
        return {"routes": "routes/linden_leap.xml", "vehicle": "vehicle.easymile.ez10", "weather": "ClearNoon"}

    def others(self, snapshot: carla.WorldSnapshot, sensor_data: Mapping[str, tuple[int, Any]]) -> list[Other]:
        """Return the actors in sight, and the people that others warn of; tell what others should know."""
        seen = super().others(snapshot, sensor_data)
        now_s = snapshot.timestamp.elapsed_seconds
        heard = heard_texts(sensor_data, RADIO, snapshot.frame)
        texts = [text for _, text in heard]
        self.people.hear(texts, now_s)
        self.order.hear(texts, now_s)
        if self.headways is not None:
            self.headways.hear(heard, now_s)
        driver = self.driver
        if driver is not None and driver.place is not None:
            self._cooperate(driver, now_s)
        self._tell(seen, now_s)
        self._ticks += 1
        return [*seen, *self.people.unseen({other.id for other in seen}, now_s)]

    def _tell(self, seen: Sequence[Other], now_s: float) -> None:
        """Send texts: people and stops at lines five times a second, departures once a second."""
        texts: list[str] = []
        if self._ticks % SHORT_TICKS == 0:
            here = self.vehicle.get_transform().location
            texts += warnings_of(seen, here.x, here.y)
            if self._standing is not None:
                texts.append(line_text(self._standing[1], now_s))
        if self._ticks % LONG_TICKS == 0 and self.headways is not None:
            departures = self.headways.text(now_s)
            texts += [] if departures is None else [departures]
        for text in texts:
            self.send(RADIO, text)

    def _cooperate(self, driver: BehavioralDriver, now_s: float) -> None:
        """Hold at service stops and lines for the others; by the state of the driver after its latest step."""
        assert driver.place is not None
        s_m, speed_mps = driver.place.s_m, self.vehicle.get_velocity().length()
        if self.headways is not None:
            for number, (rule, stop) in enumerate(zip(driver.task.stops, self.seen_route.stops, strict=True)):
                name = stop_name(stop.id)
                if rule.phase is ServicePhase.DWELLING and number not in self._held:
                    self._held.add(number)
                    rule.dwell_s += self.headways.hold_s(name, now_s + rule.dwell_s)
                elif rule.phase is ServicePhase.LEFT and speed_mps > IN_MOTION_MPS and number not in self._left:
                    self._left.add(number)
                    self.headways.left(name, now_s)
        driver.requested = ()
        front_s_m = s_m + (0.0 if self.facts is None else self.facts.body.front_m)
        self._standing = self._at_line(driver, front_s_m, speed_mps, now_s)
        if self._standing is None:
            return
        sign, standing = self._standing
        if sign.line_s_m > front_s_m - 1.0 and self.order.is_before(standing, now_s):
            driver.requested = (hold_at(sign.line_s_m, front_s_m, "another shuttle stopped first"),)

    def _at_line(
        self, driver: BehavioralDriver, front_s_m: float, speed_mps: float, now_s: float
    ) -> tuple[StopSign, StoppedVehicle] | None:
        """Return the stop sign at which the vehicle stands or behind which it crosses; None elsewhere."""
        if self._standing is not None and front_s_m < self._standing[0].line_s_m + CROSSING_M:
            return self._standing
        for sign in driver.task.stop_signs:
            if sign.phase is StopPhase.WAITING and is_resting_at(sign.line_s_m, front_s_m, speed_mps):
                place = driver.task.path.index_at(sign.line_s_m)
                x_m, y_m = float(driver.task.path.x_m[place]), float(driver.task.path.y_m[place])
                return sign, StoppedVehicle(x_m, y_m, now_s)
        return None


def heard_texts(sensor_data: Mapping[str, tuple[int, Any]], radio: str, frame: int) -> list[tuple[str, str]]:
    """Return the texts that a radio received in a frame, each with the number of the station that sent it."""
    heard_in, event = sensor_data.get(radio, (0, ()))
    if heard_in != frame:
        return []
    found = []
    for message in event:
        record = message.get()["Message"]
        found.append((str(record["Header"]["Station ID"]), str(record["Message"])))
    return found


def stop_name(stop_id: str) -> str:
    """Return a stop's id without the number of the round, which a service puts behind it."""
    return stop_id.partition("/")[0]


def headways_of(route: Route) -> Headways | None:
    """Return the view of a round that a route has; None for a route that is no round."""
    places_m: dict[str, float] = {}
    round_m = None
    for stop in route.stops:
        name = stop_name(stop.id)
        if name in places_m:
            round_m = stop.s_m - places_m[name] if round_m is None else round_m
        else:
            places_m[name] = stop.s_m
    gap_m = math.dist(route.points_m[0, :2], route.points_m[-1, :2])
    if round_m is None and gap_m < GAP_SHARE * route.length_m:
        round_m = route.length_m + gap_m
    return None if round_m is None or len(places_m) < 2 else Headways(places_m, round_m)
