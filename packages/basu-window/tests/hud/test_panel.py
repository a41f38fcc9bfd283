"""Claims about the panel: what it says, on a canvas that keeps the words."""

from typing import Any

import carla

from basu.metrics.score import Scores
from basu_window.hud.canvas import RED
from basu_window.hud.notices import Judgement
from basu_window.hud.panel import Panel, driver_word
from basu_window.hud.readings import Fix, Inertial, Rates, Readings, Setting


class Paper:
    """Keeps what is written on it, with its colour."""

    def __init__(self, height: int = 540) -> None:
        self.size = (960, height)
        self.written: dict[str, Any] = {}

    def text(self, at: tuple[float, float], text: str, colour: Any = None, **_: Any) -> None:
        assert at[1] < self.size[1], f"'{text}' is below the window"
        self.written[text] = colour

    def shade(self, box: Any, strength: float) -> None: ...

    def rectangle(self, box: Any, colour: Any, **_: Any) -> None: ...


SHOWN = Readings(
    vehicle="vehicle.tesla.model3",
    setting=Setting("Linden", "leap", "ClearSunset", "3 cameras, lidar, GNSS, IMU, collision, lane"),
    traffic=(40, 12),
    rates=Rates(21.4, 9.6, 1.07),
    manual=False,
    autopilot=False,
    tick=100,
    simulated_s=65.0,
    wall_s=13.0,
    speed_mps=13.0,
    limit_mps=11.176,
    gear=-1,
    control=carla.VehicleControl(throttle=0.5, hand_brake=True, reverse=True),
    heading_deg=44.0,
    at_m=(1.0, 2.0, 3.0),
    fix=Fix(39.99, -82.97, 249.0),
    inertial=Inertial((0.0, 0.0, 9.81), (0.0, 0.0, 0.0)),
    along_m=120.0,
    length_m=770.0,
    lateral_m=-0.1,
    judgement=Judgement(Scores(0.9, 0.8, 1.0)),
    nearby=tuple((f"vehicle.audi.tt{n}", 5.0 + n) for n in range(16)),
)


def written(shown: Readings, height: int = 540) -> dict[str, Any]:
    paper: Any = Paper(height)
    Panel(paper, "basic").draw(shown)
    result: dict[str, Any] = paper.written
    return result


def test_the_panel_says_what_there_is() -> None:
    words = written(SHOWN)
    for expected in (
        "basic",
        "AGENT",
        "29",
        "47 km/h",
        "REVERSE  HAND BRAKE  R",
        "44° NE",
        "39.990000° N, 82.970000° W",
        "Linden, leap",
        "ClearSunset",
        "3 cameras, lidar, GNSS, IMU, col…",
        "40 vehicles, 12 walkers",
        "21, 10 fps (1.1x)",
        "120 of 770 m, -0.10 m off",
        "0.900",
        "1:05.0, 0:13.0",
        "audi.tt0",
        "5 m",
    ):
        assert expected in words


def test_the_limit_turns_red_where_it_is_exceeded() -> None:
    assert written(SHOWN)["25"] == RED
    assert written(SHOWN._replace(speed_mps=11.0))["25"] != RED
    assert "LIMIT" not in written(SHOWN._replace(limit_mps=None))


def test_neighbours_take_the_room_there_is() -> None:
    few, many = (sum("audi" in word for word in written(SHOWN, height)) for height in (430, 900))
    assert few < many == 5


def test_the_badge_tells_one_that_drives() -> None:
    words = [driver_word(SHOWN._replace(manual=m, autopilot=a))[0] for m, a in ((0, 0), (1, 0), (0, 1))]
    assert words == ["AGENT", "MANUAL", "AUTOPILOT"]
