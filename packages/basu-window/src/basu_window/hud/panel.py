"""The panel on the left of the HUD (settings, instruments, places, score, neighbours), and the help page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_window.hud.canvas import BLACK, BLUE, GREEN, GREY, RED, WHITE, YELLOW
from basu_window.hud.readings import compass_point, degrees

if TYPE_CHECKING:
    from basu_window.hud.canvas import Canvas, Colour
    from basu_window.hud.readings import Readings

WIDTH, MARGIN, ROW = 250, 12, 16
MPS_PER_MPH = 0.44704
OVER_MPS = 0.25  # above the limit the sign turns red: what a display of whole mph hides
MOST_NEARBY = 5
MOST_LETTERS = 40  # of a row, so that label and value do not touch
GEARS = {-1: "R", 0: "N"}


class Panel:
    """Draws from top to bottom; ``_y`` is where the next row goes."""

    def __init__(self, canvas: Canvas, agent: str) -> None:
        self._canvas, self._agent = canvas, agent
        self._y = 0.0

    def draw(self, shown: Readings) -> None:
        """Everything."""
        self._canvas.shade((0, 0, WIDTH, self._canvas.size[1]), 0.7)
        self._y = 10.0
        self._who(shown)
        self._setting(shown)
        self._speed(shown)
        self._pedals(shown)
        self._place(shown)
        self._collisions(shown)
        self._score(shown)
        self._times(shown)
        self._nearby(shown)

    def _row(self, label: str, value: str, colour: Colour = WHITE) -> None:
        """A label on the left, its value on the right, cut where both have no room."""
        room = MOST_LETTERS - len(label)
        value = value if len(value) <= room else f"{value[: room - 1].rstrip(' ,')}…"
        self._canvas.text((MARGIN, self._y), label, GREY)
        self._canvas.text((WIDTH - MARGIN, self._y), value, colour, align=1.0)
        self._y += ROW

    def _gap(self) -> None:
        self._y += 5

    def _who(self, shown: Readings) -> None:
        """Agent, vehicle, and driver."""
        word, colour = driver_word(shown)
        self._canvas.text((MARGIN, self._y), self._agent, size=24)
        self._canvas.rectangle((WIDTH - MARGIN - 82, self._y - 1, 82, 18), colour, rounded=4)
        self._canvas.text((WIDTH - MARGIN - 41, self._y + 3), word, BLACK, size=16, align=0.5)
        self._y += 20
        self._canvas.text((MARGIN, self._y), shown.vehicle, GREY)
        self._y += ROW

    def _setting(self, shown: Readings) -> None:
        """Where, in what weather, with which sensors and how much traffic it drives."""
        setting, (vehicles, walkers) = shown.setting, shown.traffic
        self._row("Map, route", f"{setting.town}, {setting.route}")
        self._row("Weather", setting.weather)
        self._row("Sensors", setting.sensors)
        self._row("Traffic", f"{vehicles} vehicles, {walkers} walkers")

    def _speed(self, shown: Readings) -> None:
        """Speed, large, and the limit as its sign."""
        self._canvas.text((MARGIN + 64, self._y + 6), f"{shown.speed_mps / MPS_PER_MPH:.0f}", size=58, align=1.0)
        self._canvas.text((MARGIN + 70, self._y + 10), "mph", GREY, size=20)
        self._canvas.text((MARGIN + 70, self._y + 28), f"{3.6 * shown.speed_mps:.0f} km/h", GREY)
        if shown.limit_mps is not None:
            too_fast = shown.speed_mps > shown.limit_mps + OVER_MPS
            box = (WIDTH - MARGIN - 44, self._y, 44, 50)
            self._canvas.rectangle(box, WHITE, rounded=4)
            self._canvas.rectangle(box, RED if too_fast else BLACK, border=3, rounded=4)
            middle = WIDTH - MARGIN - 22
            self._canvas.text((middle, self._y + 7), "LIMIT", BLACK, size=15, align=0.5)
            limit = f"{shown.limit_mps / MPS_PER_MPH:.0f}"
            self._canvas.text((middle, self._y + 20), limit, RED if too_fast else BLACK, size=32, align=0.5)
        self._y += 56

    def _pedals(self, shown: Readings) -> None:
        """Gear, pedals, wheel and what is pulled or switched."""
        control = shown.control
        self._bar("Throttle", control.throttle, GREEN)
        self._bar("Brake", control.brake, RED)
        self._wheel(control.steer)
        gear = GEARS.get(shown.gear, f"D{shown.gear}")
        lamps = [name for name, lit in (("REVERSE", control.reverse), ("HAND BRAKE", control.hand_brake)) if lit]
        self._row("Gear", "  ".join([*lamps, gear]), YELLOW if lamps else WHITE)
        self._gap()

    def _bar(self, label: str, share: float, colour: Colour) -> None:
        """A share of a pedal's way."""
        left, width = 84, WIDTH - MARGIN - 84
        self._canvas.text((MARGIN, self._y), label, GREY)
        self._canvas.rectangle((left, self._y + 1, width, 9), GREY, border=1)
        self._canvas.rectangle((left, self._y + 1, width * share, 9), colour)
        self._y += ROW

    def _wheel(self, steer: float) -> None:
        """The wheel, from its middle."""
        left, width = 84, WIDTH - MARGIN - 84
        middle = left + width / 2
        self._canvas.text((MARGIN, self._y), "Steer", GREY)
        self._canvas.rectangle((left, self._y + 1, width, 9), GREY, border=1)
        turned = steer * width / 2
        self._canvas.rectangle((min(middle, middle + turned), self._y + 1, max(2.0, abs(turned)), 9), BLUE)
        self._y += ROW

    def _place(self, shown: Readings) -> None:
        """Where it is, which way it looks, what it feels."""
        self._row("Heading", f"{shown.heading_deg:.0f}° {compass_point(shown.heading_deg)}")
        x_m, y_m, z_m = shown.at_m
        self._row("Location", f"{x_m:.1f}, {y_m:.1f}, {z_m:.1f} m")
        self._row("GNSS", ", ".join(degrees(shown.fix, 6)))
        force, spin = shown.inertial
        self._row("Accelerometer", f"{signed(force)} m/s²")
        self._row("Gyroscope", f"{signed(spin)} °/s")
        self._gap()

    def _collisions(self, shown: Readings) -> None:
        """The last ten seconds or so of the collision sensor, the latest on the right."""
        impulses = shown.judgement.impulses(shown.tick)
        left, width, height = 84, WIDTH - MARGIN - 84, 22
        self._canvas.text((MARGIN, self._y + 6), "Collisions", GREY)
        self._canvas.rectangle((left, self._y, width, height), GREY, border=1)
        top = max(float(impulses.max()), 1.0)
        for i in impulses.nonzero()[0].tolist():
            high = max(2.0, (height - 2) * float(impulses[i]) / top)
            self._canvas.rectangle((left + width * i / len(impulses), self._y + height - 1 - high, 2, high), RED)
        self._y += height + 7

    def _score(self, shown: Readings) -> None:
        """How far, how well."""
        self._row("Route", f"{shown.along_m:.0f} of {shown.length_m:.0f} m, {shown.lateral_m:+.2f} m off")
        scores = shown.judgement.scores
        if scores is not None:
            self._row("Score so far", f"{scores.driving:.3f}", GREEN if not shown.judgement.found else YELLOW)
            self._row("", f"infractions {scores.infraction:.3f}, path {scores.path_following:.3f}", GREY)
        for line in shown.judgement.tally():
            self._row("", line, RED)
        self._gap()

    def _times(self, shown: Readings) -> None:
        """Simulated and wall time, and how fast both go."""
        self._row("Simulated, wall time", f"{clock(shown.simulated_s)}, {clock(shown.wall_s)}")
        rates = shown.rates
        self._row(
            "Server, window", f"{rates.ticks_per_s:.0f}, {rates.pictures_per_s:.0f} fps ({times(rates.real_time)})"
        )
        self._gap()

    def _nearby(self, shown: Readings) -> None:
        """Actors nearby, as far as there is room."""
        room = int((self._canvas.size[1] - self._y - 24) // ROW)
        for type_id, away_m in shown.nearby[: min(MOST_NEARBY, max(0, room))]:
            self._row(type_id.split(".", maxsplit=1)[-1], f"{away_m:.0f} m")


def driver_word(shown: Readings) -> tuple[str, Colour]:
    """Return a word for the driver, and its colour."""
    if shown.manual:
        return "MANUAL", YELLOW
    return ("AUTOPILOT", BLUE) if shown.autopilot else ("AGENT", GREEN)


def times(factor: float) -> str:
    """Return a factor with two figures or so."""
    return f"{factor:.2f}x" if factor < 1.0 else f"{factor:.1f}x"


def clock(seconds: float) -> str:
    """Minutes and seconds."""
    return f"{int(seconds // 60)}:{seconds % 60:04.1f}"


def signed(values: tuple[float, ...]) -> str:
    """To one decimal place; what rounds to nothing has no minus before it."""
    return ", ".join(f"{round(value, 1) + 0.0:+.1f}" for value in values)


KEYS = (
    ("W, arrow up", "throttle"),
    ("S, arrow down", "brake"),
    ("A D, arrows", "steer left, right; the wheel returns when they are let go"),
    ("Space", "hand brake, while it is down"),
    ("Q", "reverse, on and off"),
    ("P", "take over from the agent or autopilot, and give back"),
    ("Tab", "camera or map"),
    ("N", "the agent's next sensor; after the last, camera or map"),
    ("F1", "the panel, on and off"),
    ("F12", "picture of the window, into a file"),
    ("H, ?", "this page, on and off"),
    ("Esc", "end the run; what was driven is scored and written"),
)
HELP_WIDTH, HELP_ROW = 560, 26


def draw_help(canvas: Canvas, panel: float) -> None:
    """In the middle of what the panel, so wide, leaves free; over it where that is too narrow."""
    height = 70 + HELP_ROW * len(KEYS)
    free = canvas.size[0] - panel
    left = panel + (free - HELP_WIDTH) / 2 if free >= HELP_WIDTH else canvas.size[0] - HELP_WIDTH
    top = max(4.0, (canvas.size[1] - height) / 2)
    canvas.shade((left, top, HELP_WIDTH, height), 0.85)
    canvas.text((left + 20, top + 14), "Keys", size=30)
    canvas.text((left + HELP_WIDTH - 20, top + 20), "BASU", GREY, align=1.0)
    for row, (key, meaning) in enumerate(KEYS):
        canvas.text((left + 20, top + 52 + HELP_ROW * row), key, YELLOW, size=20)
        canvas.text((left + 150, top + 52 + HELP_ROW * row), meaning, size=20)
