"""The head-up display: shows a run in a window, and lets time pass as it does where a person drives.

Wall time decides when is drawn and how long is waited, and nothing else: the record of a run is the same without it.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import SimulatorError, UserError
from basu.files import write_bytes
from basu.managers.base_manager import BaseManager
from basu.managers.observations import Neighbours
from basu_window.hud.canvas import GREY, RED, WHITE, Canvas
from basu_window.hud.notices import Judge, Notices
from basu_window.hud.panel import WIDTH, Panel, draw_help
from basu_window.hud.readings import Around, Rates, read, setting_of
from basu_window.hud.sensor_view import ChaseCamera, SensorView
from basu_window.hud.top_down import Body, TopDown
from basu_window.manual.inputs import Strike

if TYPE_CHECKING:
    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run
    from basu.options.drive import DriveOptions
    from basu_window.hud.readings import Setting
    from basu_window.manual.inputs import Person

DRAW_EVERY_S = 0.05  # wall time, where the run is faster than that
RUN_TO_DRAW = 4.0  # there the run gets at least so many times what drawing takes
WATCH_EVERY_S = 0.1  # simulated time between two pictures where no person steers by them
SETTING_EVERY_S = 2.0  # wall time between two questions for the weather, which a route may change
RATE_S = 2.0  # of wall time, over which rates are taken
LATE_S = 0.25  # a larger lag behind real time is dropped, not caught up
PICTURE = Path("hud.png")


class Hud(BaseManager):
    """The window. Ticked after all others."""

    def __init__(self, live: Live, person: Person, options: DriveOptions, agent: str) -> None:
        self._live, self._person, self._options, self._agent = live, person, options, agent
        self._camera: ChaseCamera | None = None
        self._canvas: Canvas | None = None
        self._notices = Notices()
        self._judge = Judge(live.metrics, self._notices)
        self._pace = Pace()
        self._meter = Meter()
        self._on_map = options.hud == "map"
        self._helps = False
        self._has_panel = True
        self._was_manual = person.drives_first
        self._draw_next_s = self._began_s = 0.0
        self._latest: Frame | None = None
        self._setting: Setting | None = None
        self._setting_next_s = 0.0

    def setup(self, run: Run) -> None:
        """Open the window and hang up the camera."""
        self._run = run
        self._canvas = Canvas(
            self._options.hud_size, f"BASU: {self._agent} on route {run.route.id} of {run.route.town}"
        )
        self._panel = Panel(self._canvas, self._agent)
        self._map = TopDown(run)
        self._neighbours = Neighbours(run.world, run.vehicle.id)
        self._sensor_view = SensorView(run)
        self._began_s = time.perf_counter()
        if not self._on_map:
            self._hang_camera()
        self._notices.add("H shows the keys", time.perf_counter())

    def tick(self, frame: Frame) -> None:
        """Heed what was struck, judge, draw and wait, each where it is due."""
        now_s = time.perf_counter()
        self._latest = frame
        self._meter.tick(now_s)
        picture = self._heed(now_s)
        self._tell_driver(now_s)
        self._map.pass_by(frame)
        is_last = self._live.routes.outcome is not None
        self._judge.refresh(now_s, anyway=is_last)
        if picture or is_last or self._paced or now_s >= self._draw_next_s:
            self._draw(frame, now_s)
            drawn_s = time.perf_counter()
            self._draw_next_s = drawn_s + max(DRAW_EVERY_S, RUN_TO_DRAW * (drawn_s - now_s))
        if picture:
            self._save(self._options.hud_screenshot or PICTURE)
        if self._paced:
            self._pace.wait(self._run.step_s)
        else:
            self._pace = Pace()

    def close(self) -> None:
        """Keep a picture of the end where one was wished, and close the window."""
        if self._options.hud_screenshot is not None and self._latest is not None and self._canvas is not None:
            with contextlib.suppress(RuntimeError):  # the simulator is gone: what the window shows has to do
                self._draw(self._latest, time.perf_counter())
            self._save(self._options.hud_screenshot)
        if self._camera is not None:
            self._camera.close()
            self._camera = None
        if self._canvas is not None:
            self._canvas.close()
            self._canvas = None

    @property
    def _paced(self) -> bool:
        """Whether time has to pass as it does: a person drives, or may at any moment."""
        return self._person.live and (self._person.driving or self._person.drives_first)

    def _heed(self, now_s: float) -> bool:
        """Do what the window's keys say; whether a picture is to be taken."""
        strikes = self._person.latest.strikes
        if Strike.QUIT in strikes:
            raise KeyboardInterrupt
        for strike in strikes:
            if strike is Strike.HELP:
                self._helps = not self._helps
            elif strike is Strike.PANEL:
                self._has_panel = not self._has_panel
            elif strike is Strike.VIEW:
                self._change_view()
            elif strike is Strike.SENSOR:
                self._next_sensor(now_s)
            elif strike is Strike.SCREENSHOT:
                self._notices.add(f"picture in {(self._options.hud_screenshot or PICTURE).name}", now_s)
        return Strike.SCREENSHOT in strikes

    def _tell_driver(self, now_s: float) -> None:
        """Show a notice when person or agent takes over."""
        if self._live.agents.manual != self._was_manual:
            self._was_manual = self._live.agents.manual
            other = "the autopilot drives" if self._person.drives_first else "the agent drives"
            self._notices.add("a person drives" if self._was_manual else other, now_s)

    def _change_view(self) -> None:
        """Camera or map; back to what was there before the sensors, where one is shown."""
        if self._sensor_view.shown is None:
            self._on_map = not self._on_map
        self._sensor_view.shown = None
        self._use_camera()

    def _next_sensor(self, now_s: float) -> None:
        """The agent's next sensor."""
        if not self._live.sensors.types:
            self._notices.add("the agent has no sensors", now_s)
        self._sensor_view.step(self._live.sensors.types)
        self._use_camera()

    def _use_camera(self) -> None:
        """Have the HUD's camera take pictures only while they are shown."""
        wanted = not self._on_map and self._sensor_view.shown is None
        if self._camera is not None:
            self._camera.look(begin=wanted)
        elif wanted:
            self._hang_camera()

    def _hang_camera(self) -> None:
        """Have a camera, or the map where this simulator has none."""
        every_s = 0.0 if self._person.drives_first else WATCH_EVERY_S
        width, height = self._options.hud_size
        try:
            self._camera = ChaseCamera(self._run, (width // 2, height // 2), every_s)
        except SimulatorError as error:
            self._on_map = True
            self._notices.add(f"{error}; here is the map", time.perf_counter())

    def _draw(self, frame: Frame, now_s: float) -> None:
        """The view, and over it panel, notices and help."""
        canvas = self._canvas
        assert canvas is not None, "setup opened it"
        rows = self._neighbours.near(frame)
        picture = None if self._camera is None else self._camera.latest
        left = WIDTH if self._has_panel else 0.0
        if self._sensor_view.shown is not None:
            self._sensor_view.draw(canvas, left, self._live.sensors.types, self._live.sensors.data)
        elif self._on_map or picture is None:
            bodies = [self._body(row) for row in rows]
            self._map.draw(canvas, left, frame.ego, bodies, self._judge.latest.found)
        else:
            canvas.picture(*picture)
        if self._has_panel:
            self._panel.draw(read(self._run, self._live, frame, self._judge.latest, self._around(frame, rows, now_s)))
        self._draw_notices(canvas, now_s)
        if self._helps:
            draw_help(canvas, left)
        self._meter.picture(now_s)
        canvas.show()

    def _around(self, frame: Frame, rows: list[tuple[float, ...]], now_s: float) -> Around:
        """Return what the window keeps for the panel."""
        ego = frame.ego
        if self._setting is None or now_s >= self._setting_next_s:
            self._setting, self._setting_next_s = setting_of(self._run, self._live), now_s + SETTING_EVERY_S
        return Around(
            self._setting,
            self._neighbours.counts(),
            self._meter.rates(self._run.step_s),
            tuple((self._neighbours.met[int(row[1])], math.dist(row[2:4], (ego.x_m, ego.y_m))) for row in rows),
            now_s - self._began_s,
        )

    def _body(self, row: tuple[float, ...]) -> Body:
        """Return a neighbour's row as what is drawn."""
        _, actor_id, x_m, y_m, _, yaw_rad, *_ = row
        length_m, width_m = self._neighbours.sizes[int(actor_id)]
        walks = self._neighbours.met[int(actor_id)].startswith("walker.")
        return Body(x_m, y_m, yaw_rad, length_m, width_m, walks)

    def _draw_notices(self, canvas: Canvas, now_s: float) -> None:
        """From the bottom upwards, the latest lowest."""
        left = (WIDTH if self._has_panel else 0) + 10
        shown = self._notices.shown(now_s)
        for line, (notice, clear) in enumerate(reversed(shown)):
            top = canvas.size[1] - 26 - 22 * line
            canvas.shade((left - 4, top - 4, canvas.size[0] - left - 6, 20), 0.55 * min(1.0, 2.0 * clear))
            canvas.text((left, top - 1), notice.text, RED if notice.bad else WHITE if clear > 0.5 else GREY)

    def _save(self, path: Path) -> None:
        """Write the window into a file; where that fails, the run goes on."""
        assert self._canvas is not None, "setup opened it"
        try:
            write_bytes(path, self._canvas.png())
        except UserError as error:
            self._notices.add(str(error), time.perf_counter(), bad=True)


class Meter:
    """Counts ticks and pictures of the last ``RATE_S``; times are of ``time.perf_counter``."""

    def __init__(self) -> None:
        self._ticks_s: deque[float] = deque()
        self._pictures_s: deque[float] = deque()

    def tick(self, now_s: float) -> None:
        """Count a step of the server."""
        self._ticks_s.append(now_s)

    def picture(self, now_s: float) -> None:
        """Count a drawing of the window."""
        self._pictures_s.append(now_s)

    def rates(self, step_s: float) -> Rates:
        """Return the rates up to the last tick."""
        ticks_per_s, pictures_per_s = (self._per_s(times_s) for times_s in (self._ticks_s, self._pictures_s))
        return Rates(ticks_per_s, pictures_per_s, ticks_per_s * step_s)

    @staticmethod
    def _per_s(times_s: deque[float]) -> float:
        while times_s and times_s[-1] - times_s[0] > RATE_S:
            times_s.popleft()
        return (len(times_s) - 1) / (times_s[-1] - times_s[0]) if len(times_s) > 1 else 0.0


class Pace:
    """Waits so that steps come no faster than real time."""

    def __init__(self) -> None:
        self._due_s: float | None = None

    def wait(self, step_s: float) -> None:
        """Wait until this step's time has come."""
        now_s = time.perf_counter()
        due_s = now_s if self._due_s is None or now_s - self._due_s > LATE_S else self._due_s
        if due_s > now_s:
            time.sleep(due_s - now_s)
        self._due_s = due_s + step_s
