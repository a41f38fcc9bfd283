"""When a station sends a cooperative awareness message: ETSI EN 302 637-2 V1.4.1, 6.1.3.

A vehicle sends when it has turned, moved or changed its speed enough since its last message; else when the interval
that it last kept has passed. After three such messages the interval is the greatest again. CARLA 0.9.16 leaves the
number three unset. The channel is never congested (no restriction by DCC), as in CARLA. The rules are checked once a
frame, so a frame longer than the least interval has one message.
"""

import math
from typing import NamedTuple

from linden.protocol.values.space import Vector3D
from linden.sensors.devices.attributes import ROUNDING_S
from linden.sensors.devices.radio.spec import CamSpec

HEADING_DEG = 4.0
DISTANCE_M = 4.0
SPEED_MPS = 0.5
"""Changes that call for a message, each beyond the limit."""
MESSAGES_AT_AN_INTERVAL = 3
"""N_GenCam: as many messages keep the interval that a change has made short."""
FACTS_INTERVAL_S = 0.5
"""The low-frequency container comes with the first message, and with one after at least this time."""


class StationMotion(NamedTuple):
    """The motion of a station, by which the rules of generation decide."""

    location: Vector3D  # in the world, m
    heading_deg: float
    speed_mps: float  # along the vehicle, negative backwards


class Generation(NamedTuple):
    """A station between two frames; nothing is sent before the first."""

    interval_s: float = 0.0  # T_GenCam
    last_s: float = -math.inf
    last: StationMotion | None = None
    kept: int = 0  # messages since the interval was made
    facts_s: float = -math.inf
    made: int = 0


class Due(NamedTuple):
    """Whether there is a message in this frame, and whether it carries the low-frequency container."""

    message: bool
    facts: bool


def generate(before: Generation, spec: CamSpec, motion: StationMotion | None, now_s: float) -> tuple[Due, Generation]:
    """Return what is due at ``now_s``, and the station after it; to be called once in every frame.

    A road side unit has no ``motion``. It sends at the greatest interval, without the container.
    """
    passed_s = now_s - before.last_s + ROUNDING_S
    if motion is None:
        due = passed_s >= spec.greatest_interval_s
        return Due(due, facts=False), before._replace(last_s=now_s, made=before.made + 1) if due else before
    if passed_s < spec.least_interval_s:
        return Due(message=False, facts=False), before
    interval_s, kept = before.interval_s or spec.greatest_interval_s, before.kept
    if spec.fixed_rate:
        pass
    elif before.last is None or _has_changed(before.last, motion):
        interval_s, kept = min(passed_s - ROUNDING_S, spec.greatest_interval_s), 0
    elif passed_s >= interval_s:
        kept += 1
        if kept >= MESSAGES_AT_AN_INTERVAL:
            interval_s = spec.greatest_interval_s
    else:
        return Due(message=False, facts=False), before
    facts = now_s - before.facts_s + ROUNDING_S >= FACTS_INTERVAL_S
    after = Generation(interval_s, now_s, motion, kept, now_s if facts else before.facts_s, before.made + 1)
    return Due(message=True, facts=facts), after


def _has_changed(last: StationMotion, now: StationMotion) -> bool:
    turned_deg = abs((now.heading_deg - last.heading_deg + 180.0) % 360.0 - 180.0)
    return (
        turned_deg > HEADING_DEG
        or math.dist(now.location, last.location) > DISTANCE_M
        or abs(now.speed_mps - last.speed_mps) > SPEED_MPS
    )
