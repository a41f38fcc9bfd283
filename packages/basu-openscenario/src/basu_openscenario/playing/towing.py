"""Trailers behind their vehicles: connected, disconnected, and pulled, so that their axle does not slip sideways."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.running_action import AtOnce
from basu_openscenario.reading.trailers import check_coupling

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import ConnectTrailerAction


def connect(tow: Mover, trailer: Mover) -> None:
    """Let a vehicle tow a trailer, which leaves the vehicle that towed it before; so does its former trailer."""
    disconnect(tow)
    if trailer.tow is not None:
        disconnect(trailer.tow)
    tow.trailer, trailer.tow = trailer, tow


def disconnect(tow: Mover) -> None:
    """Let a vehicle go on without its trailer."""
    if tow.trailer is not None:
        tow.trailer.tow = None
        tow.trailer = None


def align(front: Mover) -> None:
    """Put all trailers of a vehicle in a line behind it."""
    for tow, trailer in _couplings(front):
        h_rad = front.place.h_rad
        x_m, y_m = _hitch(tow, h_rad)
        coupler_m = trailer.entity.coupler_m or 0.0
        trailer.place.set_world(x_m - coupler_m * math.cos(h_rad), y_m - coupler_m * math.sin(h_rad), h_rad)
        trailer.set_speed(front.speed_mps)
        trailer.teleported = trailer.moved_along = True


def pull_trailers(movers: Iterable[Mover]) -> None:
    """Pull the trailers of all vehicles after these have moved, the front one first.

    The axle of a trailer goes straight towards the hitch, at its distance from it: the curve of pursuit that is called
    tractrix, in steps.
    """
    for front in movers:
        if front.tow is not None:
            continue
        for tow, trailer in _couplings(front):
            x_m, y_m = _hitch(tow, tow.place.h_rad)
            back_rad = math.atan2(trailer.place.y_m - y_m, trailer.place.x_m - x_m)
            coupler_m = trailer.entity.coupler_m or 0.0
            place = x_m + coupler_m * math.cos(back_rad), y_m + coupler_m * math.sin(back_rad)
            trailer.place.set_world(*place, math.remainder(back_rad + math.pi, math.tau))
            trailer.set_speed(tow.speed_mps)
            trailer.moved_along = True


def _couplings(front: Mover) -> Iterator[tuple[Mover, Mover]]:
    """Yield each towing vehicle with its trailer, from the front on."""
    tow = front
    while tow.trailer is not None and tow.trailer is not front:
        yield tow, tow.trailer
        tow = tow.trailer


def _hitch(tow: Mover, h_rad: float) -> tuple[float, float]:
    """Return the place of a hitch in m, with the vehicle turned to ``h_rad``."""
    hitch_m = tow.entity.hitch_m or 0.0
    return tow.place.x_m + hitch_m * math.cos(h_rad), tow.place.y_m + hitch_m * math.sin(h_rad)


class TrailerConnection(AtOnce):
    """Connects a trailer, which is then pulled from where it is."""

    def __init__(self, name: str, world: World, mover: Mover, action: ConnectTrailerAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action

    def prepare(self) -> None:
        """Connect the trailer."""
        trailer = self.world.mover(self.action.entity)
        check_coupling(self.mover.entity, trailer.entity, trailer.name, self.line)
        if any(trailer in pair for pair in _couplings(self.mover)) and self.mover.trailer is not trailer:
            return
        connect(self.mover, trailer)


class TrailerDisconnection(AtOnce):
    """Disconnects the trailer of a vehicle, if it has one."""

    def prepare(self) -> None:
        """Disconnect the trailer."""
        disconnect(self.mover)
