"""Claim about a whole drive by hand in a real browser: keyboard, gamepad and wheel, one after the other, to the end."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

from basu.records.history.files import read_history
from basu_fixtures import SHORT_ROUTE
from browsers import running_browser
from page_drives import PAD, WHEEL, started
from window_pages import page_of

FASTEST_MPS = 5.8  # the limit is 6.7
ACROSS_MPS2, SLOWS_MPS2 = 1.0, 1.0
WHEELBASE_M, FRONT_M = 2.8, 2.0
FULL_STEER_RAD = 1.22
STUCK_S = 60.0
"""Simulated time without progress after which the drive has failed; a busy machine takes more wall time."""
STATE = """(() => { const pose = page.followed();
  return pose && [pose.x, pose.y, pose.yaw, pose.speed, pose.steer, page.connection.hasEnded,
    page.timeline.time(page.timeline.last)]; })()"""


class Hands:
    """What a driver's hands do with one device in a page: pedals from -1 (brake) to 1, wheel from -1 to 1."""

    def __init__(self, page: Page) -> None:
        self.page, self.down = page, set[str]()

    def keys(self, pedals: float, steer: float, turned: float) -> None:
        """Press W or S, and A or D for as long as the wheel is not where it should be."""
        wanted = {"w"} if pedals > 0.1 else {"s"} if pedals < -0.1 else set()
        wanted |= {"d"} if steer - turned > 0.03 else {"a"} if turned - steer > 0.03 else set()
        for key in self.down - wanted:
            self.page.keyboard.up(key)
        for key in wanted - self.down:
            self.page.keyboard.down(key)
        self.down = wanted

    def pad(self, pedals: float, steer: float) -> None:
        """Move the left stick, out of its dead zone, and the triggers."""
        stick = math.copysign(0.1 + 0.9 * abs(steer), steer) if abs(steer) > 0.005 else 0.0
        self.page.evaluate(PAD.format(steer=stick, throttle=max(0.0, pedals), brake=max(0.0, -pedals)))

    def wheel(self, pedals: float, steer: float) -> None:
        """Turn the wheel, and move the pedals, which rest at 1."""
        throttle, brake = 1.0 - 2.0 * max(0.0, pedals), 1.0 - 2.0 * max(0.0, -pedals)
        self.page.evaluate(WHEEL.format(steer=steer, throttle=throttle, brake=brake))


class Driver:
    """Follows the route of a page by what the page shows, and stops at its stop signs."""

    def __init__(self, page: Page) -> None:
        self.points = np.array(page.evaluate("page.map.route"))[:, :2]
        step = np.diff(self.points, axis=0)
        self.gone = np.append(0.0, np.cumsum(np.hypot(*step.T)))
        yaw = np.unwrap(np.arctan2(*step.T[::-1]))
        middle = (self.gone[:-1] + self.gone[1:]) / 2.0
        bend = np.abs(np.interp(self.gone + 2.5, middle, yaw) - np.interp(self.gone - 2.5, middle, yaw)) / 5.0
        self.mps = np.minimum(FASTEST_MPS, np.sqrt(ACROSS_MPS2 / np.maximum(bend, 1e-6)))
        controls = page.evaluate("page.map.controls.filter(({kind}) => kind === 'stop_sign').map(({x, y}) => [x, y])")
        self.stops = [self.along(x, y) for x, y in controls]
        self.at_m = 0.0

    def along(self, x: float, y: float) -> float:
        return float(self.gone[np.argmin(np.hypot(*(self.points - (x, y)).T))])

    def wishes(self, x: float, y: float, yaw_deg: float, speed: float) -> tuple[float, float]:
        """Return pedals and wheel."""
        near = np.abs(self.gone - self.at_m) < 30.0
        away = np.where(near, np.hypot(*(self.points - (x, y)).T), np.inf)
        self.at_m = float(self.gone[np.argmin(away)])
        ahead = (self.gone >= self.at_m) & (self.gone < self.at_m + 25.0)
        wanted = float(np.sqrt(self.mps[ahead] ** 2 + 2.0 * SLOWS_MPS2 * (self.gone[ahead] - self.at_m)).min())
        if self.stops:
            left_m = self.stops[0] - self.at_m - FRONT_M
            wanted = min(wanted, math.sqrt(2.0 * SLOWS_MPS2 * max(0.0, left_m - 1.0)))
            if speed < 0.05 and left_m < 3.0:
                self.stops.pop(0)
        target = min(int(np.searchsorted(self.gone, self.at_m + 3.0 + 0.5 * speed)), len(self.points) - 1)
        to_x, to_y = self.points[target] - (x, y)
        turn = math.atan2(to_y, to_x) - math.radians(yaw_deg)
        steer = math.atan2(2.0 * WHEELBASE_M * math.sin(turn), max(1.0, math.hypot(to_x, to_y))) / FULL_STEER_RAD
        error = wanted - speed
        pedals = 0.3 + 0.6 * error if error > 0.0 else 0.5 * (error + 0.3)
        return max(-0.6, min(0.9, pedals)), max(-0.7, min(0.7, steer))


@pytest.mark.slow
@pytest.mark.timeout(1800.0)
def test_keyboard_gamepad_and_wheel_drive_the_whole_short_route(tmp_path: Path) -> None:
    words = ("run", "human", "--watch", "--routes", SHORT_ROUTE, "--output", tmp_path)
    with running_browser() as browser, started(*words) as (process, address):
        page = page_of(browser, address + "?flat")
        page.wait_for_function("globalThis.page?.input.isOn && page.map.route.length && page.followed()")
        driver, hands = Driver(page), Hands(page)
        used, reached_m, reached_s = {"keyboard": 0, "gamepad": 0, "wheel": 0}, 0.0, 0.0
        while (state := page.evaluate(STATE)) and not state[5] and process.poll() is None:
            x, y, yaw, speed, turned, _, now_s = state
            pedals, steer = driver.wishes(x, y, yaw, speed)
            if driver.at_m > reached_m + 1.0:
                reached_m, reached_s = driver.at_m, now_s
            assert now_s < reached_s + STUCK_S, f"{reached_m:.0f} m of {driver.gone[-1]:.0f} m"
            share = driver.at_m / driver.gone[-1]
            if share < 1 / 3:
                hands.keys(pedals, steer, turned / FULL_STEER_RAD)
                used["keyboard"] += 1
            elif share < 2 / 3:
                hands.keys(0.0, 0.0, 0.0)
                hands.pad(pedals, steer)
                used["gamepad"] += 1
            else:
                hands.wheel(pedals, steer)
                used["wheel"] += 1
            page.wait_for_timeout(20)
        process.communicate(timeout=120)
        assert page.errors == []
    (folder,) = [each for each in tmp_path.iterdir() if (each / "history.parquet").exists() and not each.is_symlink()]
    result = json.loads((folder / "result.json").read_text())
    assert result["status"] == "Completed", result["message"]
    assert result["reported"]["route_completion"] > 0.98
    assert (result["collisions"]["number"], result["infractions"]) == (0, [])
    assert read_history(folder).frames["manual"].all()
    assert min(used.values()) > 50, used
