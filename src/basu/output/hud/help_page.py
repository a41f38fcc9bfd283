"""The keys, as the help page (H) and the manual show them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.hud.canvas import GREY, YELLOW

if TYPE_CHECKING:
    from basu.output.hud.canvas import Canvas

KEYS = (
    ("W, arrow up", "throttle"),
    ("S, arrow down", "brake"),
    ("A D, arrows", "steer left, right; the wheel returns when they are let go"),
    ("Space", "hand brake, while it is down"),
    ("Q", "reverse, on and off"),
    ("P", "take over from the agent or autopilot, and give back"),
    ("Tab", "camera or map"),
    ("F1", "the panel, on and off"),
    ("F12", "picture of the window, into a file"),
    ("H, ?", "this page, on and off"),
    ("Esc", "end the run; what was driven is scored and written"),
)
WIDTH, ROW = 560, 26


def draw_help(canvas: Canvas, panel: float) -> None:
    """In the middle of what the panel, so wide, leaves free; over it where that is too narrow."""
    height = 70 + ROW * len(KEYS)
    free = canvas.size[0] - panel
    left = panel + (free - WIDTH) / 2 if free >= WIDTH else canvas.size[0] - WIDTH
    top = max(4.0, (canvas.size[1] - height) / 2)
    canvas.shade((left, top, WIDTH, height), 0.85)
    canvas.text((left + 20, top + 14), "Keys", size=30)
    canvas.text((left + WIDTH - 20, top + 20), "BASU", GREY, align=1.0)
    for row, (key, meaning) in enumerate(KEYS):
        canvas.text((left + 20, top + 52 + ROW * row), key, YELLOW, size=20)
        canvas.text((left + 150, top + 52 + ROW * row), meaning, size=20)
