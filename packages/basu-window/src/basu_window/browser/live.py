"""``basu run AGENT --watch``: the drive in the page while it lasts, and a person's input from the page."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.errors import UserError
from basu.managers.base_manager import BaseManager
from basu.managers.observations import Neighbours, vehicle_of
from basu.records.history.model import FRAME, Facts
from basu.routing import ControlKind
from basu_window.browser.frames import (
    Moment,
    actors_note,
    as_others,
    ego_rows,
    mark_of,
    other_actor,
    other_rows,
    panel_note,
    route_note,
)
from basu_window.browser.judge import Judge
from basu_window.browser.pace import Meter, Pace
from basu_window.browser.readings import Around, note_of, read, setting_of
from basu_window.browser.sensor_panes import pane
from basu_window.manual.inputs import Strike
from linden.errors import UserError as LindenError
from linden_window import poses
from linden_window.link import PageLink

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run
    from basu_window.browser.page_input import PageInput
    from basu_window.manual.inputs import Person

PANEL_EVERY_S = 0.5
READINGS_EVERY_S = 0.1
WEATHER_EVERY_S = 5.0
WAITS_FOR_PAGE_S = 300.0
"""How long a drive by hand waits for a page: a person copies an address within a minute."""
_POLL_S = 0.05
_COLUMNS = frozenset(FRAME.names or ())
_WEATHER = (
    "cloudiness", "precipitation", "precipitation_deposits", "wetness", "sun_azimuth_angle", "sun_altitude_angle",
    "fog_density", "fog_distance",
)  # fmt: skip


class WatchManager(BaseManager):
    """Shows each tick in the page as it is recorded; the record is the same without a page."""

    def __init__(
        self, live: Live, person: Person, devices: PageInput, agent: str, say: Callable[[str], None], port: int = 0
    ) -> None:
        """Observe ``live``; ``say`` prints the page's address, ``devices`` gets what pages send."""
        self._live, self._person, self._devices, self._say = live, person, devices, say
        self._agent, self._port = agent, port
        self._link: PageLink | None = None
        self._pages = 0
        self._known: set[int] = set()
        self._judge = Judge(live.metrics)
        self._pace = Pace()
        self._meter = Meter()
        self._panel_next_s = self._weather_next_s = self._readings_next_s = 0.0
        self._began_s = time.perf_counter()
        self._was_manual = person.drives_first
        self._wishes: dict[int, list[str]] = {}
        self._shown: dict[str, int] = {}
        self._signals: list[int] = []
        self._accelerations: list[float] = []
        self._marks = 0
        self._has_shown = False

    def setup(self, run: Run) -> None:
        """Open the page's port; if a person drives, wait until a page is open.

        Raises:
            UserError: the port is taken, or no page was opened.
        """
        self._run = run
        try:
            self._link = link = PageLink.start(port=self._port)
        except LindenError as error:
            raise UserError(str(error)) from error
        self._say(f"window            {link.address}")
        self._neighbours = run.neighbours or Neighbours(run.world, run.vehicle.id)
        self._vehicle = vehicle_of(run.vehicle)
        name = run.carla_map.name.rpartition("/")[2]
        link.note({"type": "map", "name": name, "text": run.carla_map.to_opendrive()})
        self._tell_actors()
        link.note(route_note(run.route, drives=True))
        sensors = [{"name": name, "type": type_id} for name, type_id in self._live.sensors.types.items()]
        link.note({"type": "sensors", "sensors": sensors})
        self._lights = [
            run.world.get_traffic_light_from_opendrive_id(control.landmark_id)
            if control.kind is ControlKind.TRAFFIC_LIGHT
            else None
            for control in run.route.controls
        ]
        if self._person.live and self._person.drives_first:
            self._wait_for_page(link)

    def _wait_for_page(self, link: PageLink) -> None:
        until_s = time.perf_counter() + WAITS_FOR_PAGE_S
        self._say("window            the drive begins when the page is open")
        while not self._pages:
            if not link.is_open or time.perf_counter() > until_s:
                raise UserError(
                    f"no page was opened within {WAITS_FOR_PAGE_S:.0f} s; open the address of the window in a browser "
                    "on this machine, and begin again"
                )
            self._heed(link)
            time.sleep(_POLL_S)

    def tick(self, frame: Frame) -> None:
        """Send the frame and what is new, take what pages sent, and wait where a person drives."""
        link, now_s = self._link, time.perf_counter()
        if link is None:
            return
        self._heed(link)
        if Strike.QUIT in self._person.latest.strikes:
            raise KeyboardInterrupt
        ego = frame.ego
        self._meter.tick(now_s)
        self._accelerations.append(float(np.hypot(ego.acceleration_x_mps2, ego.acceleration_y_mps2)))
        if self._pages:
            self._show(link, frame, now_s)
        if self._person.live and (self._person.driving or self._person.drives_first):
            self._pace.wait(self._run.step_s)
        else:
            self._pace = Pace()

    def close(self) -> None:
        """Close the page's port; open pages say that the drive has ended."""
        if self._link is not None:
            if self._has_shown:  # what happened since the last look at the record
                self._judge.refresh(time.perf_counter(), anyway=True)
                self._tell_marks(self._link)
            self._link.close()
            self._link = None

    def _heed(self, link: PageLink) -> None:
        for order in link.orders():
            if order["order"] == "pages":
                is_new, self._pages = order["count"] > self._pages, order["count"]
                if is_new:
                    self._panel_next_s = self._weather_next_s = self._readings_next_s = 0.0
            elif order["order"] == "sensors":
                names = order.get("names")
                self._wishes[order["page"]] = [str(name) for name in names] if isinstance(names, list) else []
                self._shown = {}
            else:
                if order["order"] == "left":
                    self._wishes.pop(order["page"], None)
                self._devices.take(order)

    def _show(self, link: PageLink, frame: Frame, now_s: float) -> None:
        rows = self._neighbours.near(frame)
        if not self._known.issuperset(self._neighbours.met):
            self._tell_actors()
        own, others = ego_rows(self._recorded(frame)), other_rows(as_others(rows))
        link.frame(poses.message(frame.tick, frame.tick * self._run.step_s, own, others))
        self._has_shown = True
        is_last = self._live.routes.outcome is not None
        if now_s >= self._panel_next_s or is_last:
            self._panel_next_s = now_s + PANEL_EVERY_S
            self._judge.refresh(now_s, anyway=is_last)
            link.note(self._panel(frame))
            self._tell_marks(link)
        if now_s >= self._weather_next_s:
            self._weather_next_s = now_s + WEATHER_EVERY_S
            weather = self._run.world.get_weather()
            link.note({"type": "weather", "weather": {name: getattr(weather, name) for name in _WEATHER}})
            self._setting = setting_of(self._run, self._live, weather)
        if now_s >= self._readings_next_s or is_last:
            self._readings_next_s = now_s + READINGS_EVERY_S
            self._show_readings(link, frame, rows, now_s)
            self._show_sensors(link)

    def _tell_marks(self, link: PageLink) -> None:
        """Send all infractions so far, if there are others than before."""
        found = self._judge.latest.found
        if len(found) != self._marks:
            self._marks = len(found)
            link.note({"type": "marks", "marks": [mark_of(each) for each in found]})

    def _show_readings(self, link: PageLink, frame: Frame, rows: list[tuple[float, ...]], now_s: float) -> None:
        """Send figures, the state of traffic lights, and a sentence if the driver has changed."""
        ego = frame.ego
        nearby = tuple((self._neighbours.met[int(row[1])], math.dist(row[2:4], (ego.x_m, ego.y_m))) for row in rows)
        around = Around(
            self._setting, self._neighbours.counts(), self._meter.ticks_per_s, nearby, now_s - self._began_s
        )
        link.note(note_of(read(self._run, self._live, frame, self._judge.latest, around), self._agent))
        signals = [-1 if light is None else int(light.get_state()) for light in self._lights]
        if signals != self._signals:
            self._signals = signals
            link.note({"type": "signals", "states": signals})
        if self._live.agents.manual != self._was_manual:
            self._was_manual = self._live.agents.manual
            other = "The autopilot drives." if self._person.drives_first else "The agent drives."
            link.note({"type": "says", "text": "A person drives." if self._was_manual else other})

    def _show_sensors(self, link: PageLink) -> None:
        """Send new measurements of the sensors that pages show; a link that is behind gets none."""
        types, data = self._live.sensors.types, self._live.sensors.data
        for name in {name for names in self._wishes.values() for name in names} & data.keys():
            number, measured = data[name]
            if self._shown.get(name) != number and not link.is_behind:
                self._shown[name] = number
                link.pane(name, pane(name, types[name], number, measured, self._run.carla_map))

    def _panel(self, frame: Frame) -> dict[str, Any]:
        ego, judged = frame.ego, self._judge.latest
        limit_mps = float(self._run.vehicle.get_speed_limit()) / 3.6
        recent = self._accelerations[-round(1.0 / self._run.step_s) :]
        self._accelerations = recent
        moment = Moment(
            frame.tick * self._run.step_s, ego.speed_mps, limit_mps, self._live.routes.progress.s_m,
            max(recent, default=0.0), self._live.agents.manual,
        )  # fmt: skip
        title = f"{self._agent} on route {self._run.route.id}"
        return panel_note(title, self._run.route, moment, judged.scores, judged.found)

    def _recorded(self, frame: Frame) -> np.ndarray[Any, Any]:
        """Return the frame in the columns of the record that the page shows."""
        row = np.zeros(1, FRAME)
        for name, value in frame.ego._asdict().items():
            if name in _COLUMNS:
                row[name] = value
        control = self._live.agents.control
        row["applied_throttle"], row["applied_steer"], row["applied_brake"] = (
            control.throttle, control.steer, control.brake,
        )  # fmt: skip
        row["applied_reverse"], row["manual"] = control.reverse, self._live.agents.manual
        row["speed_limit_mps"] = self._run.vehicle.get_speed_limit() / 3.6
        return row

    def _tell_actors(self) -> None:
        """Send what actors are, as often as a new one has come near."""
        assert self._link is not None, "setup opened it"
        met = self._neighbours.met
        self._known = set(met)
        facts = Facts(
            step_s=self._run.step_s, vehicle=self._vehicle, route=self._run.route, actor_types={}, actor_sizes={}
        )
        actors = actors_note(facts, self._agent)
        actors += [other_actor(each, type_id, self._neighbours.sizes[each]) for each, type_id in met.items()]
        self._link.note({"type": "actors", "actors": actors})
