"""Keys as pedals and wheel: pure functions of what was and what is held down.

The figures are those of CARLA's ``manual_control.py`` (0.9.16, ``_parse_vehicle_keys``) at its 20 frames a second, as
rates, so that they hold for every step: throttle is there after half a second, brake after a quarter, the wheel turns
by half its range a second up to 0.7. There the wheel snaps back when a key is let go; here it returns.
"""

from __future__ import annotations

from typing import NamedTuple

from basu.agents.manual.inputs import Held

THROTTLE_1PS = 2.0
BRAKE_1PS = 4.0
STEER_1PS = 0.5
CENTRE_1PS = 1.5  # back towards the middle, hands off or against the turn: three times as fast as into it
MOST_STEER = 0.7


class Hands(NamedTuple):
    """Pedals and wheel as keys have brought them, in CARLA's ranges."""

    throttle: float = 0.0
    brake: float = 0.0
    steer: float = 0.0


def after(hands: Hands, held: Held, dt_s: float) -> Hands:
    """Pedals and wheel after ``dt_s`` with these keys down."""
    return Hands(
        throttle=min(1.0, hands.throttle + THROTTLE_1PS * dt_s) if Held.THROTTLE in held else 0.0,
        brake=min(1.0, hands.brake + BRAKE_1PS * dt_s) if Held.BRAKE in held else 0.0,
        steer=steer_after(hands.steer, held, dt_s),
    )


def steer_after(steer: float, held: Held, dt_s: float) -> float:
    """The wheel after ``dt_s``; both keys at once are none."""
    way = float(Held.RIGHT in held) - float(Held.LEFT in held)
    if way * steer > 0.0 or (way != 0.0 and steer == 0.0):
        turned = steer + way * STEER_1PS * dt_s
        # a wheel that an agent had turned farther than keys can stays there until it is let go
        return max(-max(MOST_STEER, -steer), min(max(MOST_STEER, steer), turned))
    back = CENTRE_1PS * dt_s
    return max(0.0, steer - back) if steer > 0.0 else min(0.0, steer + back)
