"""SUMO by itself: plays a scenario with vehicles that were driven elsewhere, and reads its outputs.

A vehicle that was driven elsewhere follows its record, and SUMO's drivers give way to it. Trips begin and end as the
scenario has them, unlike beside a simulator (`trip_starts`, `trip_ends`).
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET  # SUMO's own files
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from basu.errors import SimulatorError, UserError
from basu_sumo.frames import to_sumo
from basu_sumo.link import Link, in_process
from basu_sumo.mirrors import AT_ONCE_MPS2, EXACT
from basu_sumo.outputs import Outputs
from basu_sumo.road_users import MIRROR

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

F64 = NDArray[np.float64]
MG_PER_KG = 1e6


class DrivenElsewhere(NamedTuple):
    """The record of a vehicle, CARLA's frame; arrays of one shape (N,)."""

    name: str
    length_m: float
    width_m: float
    t_s: F64
    x_m: F64
    y_m: F64
    yaw_rad: F64
    speed_mps: F64


class Trip(NamedTuple):
    """One vehicle of SUMO as its trip information has it."""

    wanted_s: float  # the departure that its demand gives
    delay_s: float  # before the departure
    duration_s: float
    loss_s: float  # against the speed that it would like
    length_m: float
    co2_kg: float
    nox_g: float
    pm_g: float
    fuel_kg: float
    electricity_kwh: float
    arrived: bool


class Trips(NamedTuple):
    """The trip information of SUMO: vehicles, and the duration of each person's walks in s (None: under way)."""

    vehicles: dict[str, Trip]
    walks_s: dict[str, float | None]


def play_alone(
    config: Path,
    folder: Path,
    *,
    seed: int,
    step_s: float,
    until_s: float,
    latest_s: float,
    elsewhere: Sequence[DrivenElsewhere] = (),
    more: Path | None = None,
) -> None:
    """Play a scenario to ``latest_s``; trips and persons that depart after ``until_s`` are taken out.

    Two plays have the same length, whatever arrives when. SUMO's outputs are written into ``folder`` below
    `basu_sumo.outputs.FOLDER`. ``more`` is a route file beside those of the scenario.

    Raises:
        UserError: SUMO is not installed, or refuses the scenario.
        SimulatorError: SUMO failed.
    """
    outputs = Outputs(folder, "")
    options = [*outputs.alone, "--device.emissions.probability", "1", "--route-steps", "0"]
    routes = _routes(config) + ([] if more is None else [str(more.resolve())])
    options += ["--route-files", ",".join(routes)]
    link = in_process(config, step_s=step_s, seed=seed, more=options)
    try:
        with link.answering("playing by itself"):
            _play(link, step_s, until_s, latest_s, elsewhere)
    finally:
        link.close()
    outputs.finish()


def _play(link: Link, step_s: float, until_s: float, latest_s: float, elsewhere: Sequence[DrivenElsewhere]) -> None:
    """Make the steps; records end with their last row, and their vehicles leave SUMO then."""
    api = link.api
    for each in elsewhere:
        _add(link, each)
    gone: set[str] = set()
    for number in range(round(latest_s / step_s)):
        t_s = number * step_s
        for each in elsewhere:
            if each.name in gone:
                continue
            if t_s > each.t_s[-1]:
                gone.add(each.name)
                api.vehicle.remove(MIRROR + each.name)
                continue
            row = min(int(np.searchsorted(each.t_s, t_s + 1e-6, side="right")), len(each.t_s)) - 1
            _move(link, each, max(row, 0), is_first=number == 0)
        link.step()
        if until_s <= t_s < until_s + step_s:
            _keep_out(link)


def _add(link: Link, each: DrivenElsewhere) -> None:
    """Add a vehicle of a record, as `mirrors` adds those of a simulator."""
    api, name = link.api, MIRROR + each.name
    api.vehicletype.copy("DEFAULT_VEHTYPE", name)
    api.vehicletype.setLength(name, each.length_m)
    api.vehicletype.setWidth(name, each.width_m)
    expected_mps2 = api.vehicletype.getDecel(name)
    api.vehicletype.setEmergencyDecel(name, AT_ONCE_MPS2)
    api.vehicletype.setDecel(name, AT_ONCE_MPS2)
    api.vehicletype.setApparentDecel(name, expected_mps2)
    api.route.add(name, [next(edge for edge in api.edge.getIDList() if not edge.startswith(":"))])
    api.vehicle.add(name, name, typeID=name)


def _move(link: Link, each: DrivenElsewhere, row: int, *, is_first: bool) -> None:
    name = MIRROR + each.name
    x_m, y_m, yaw_deg = float(each.x_m[row]), float(each.y_m[row]), math.degrees(float(each.yaw_rad[row]))
    at = to_sumo(x_m, y_m, yaw_deg, 0.5 * each.length_m, link.offset_m)
    link.api.vehicle.moveToXY(name, "", -1, *at, keepRoute=EXACT)
    if not is_first:
        link.api.vehicle.setPreviousSpeed(name, float(each.speed_mps[row]))


def _keep_out(link: Link) -> None:
    """Take out of SUMO all that has not departed yet."""
    api = link.api
    for name in api.simulation.getPendingVehicles():
        api.vehicle.remove(name)
    now_s = api.simulation.getTime()
    for name in api.vehicle.getLoadedIDList():
        if name not in set(api.vehicle.getIDList()) and api.vehicle.getDeparture(name) < 0.0:
            api.vehicle.remove(name)
    for name in api.person.getIDList():
        if api.person.getStage(name, 0).depart > now_s:
            api.person.remove(name)


def _routes(config: Path) -> list[str]:
    """Return the route files of a configuration.

    Raises:
        UserError: it is no XML file.
    """
    try:
        found = ET.parse(config).getroot().find("input/route-files")  # noqa: S314 - the user's own file
    except (OSError, ET.ParseError) as error:
        raise UserError(f"SUMO's configuration {config} cannot be read: {error}") from error
    names = [] if found is None else found.get("value", "").split(",")
    return [str((config.parent / name.strip()).resolve()) for name in names if name.strip()]


def read_trips(folder: Path) -> Trips:
    """Read the trip information that ``play_alone`` has left in a folder; vehicles of records are left out.

    Raises:
        SimulatorError: SUMO has left none.
    """
    path = Outputs.trips_of(folder)
    try:
        root = ET.parse(path).getroot()  # noqa: S314 - SUMO's own file
    except (OSError, ET.ParseError) as error:
        raise SimulatorError(f"SUMO has left no trip information in {path}: {error}") from error
    vehicles = {
        each.attrib["id"]: _trip(each) for each in root.iter("tripinfo") if not each.attrib["id"].startswith(MIRROR)
    }
    walks_s: dict[str, float | None] = {}
    for person in root.iter("personinfo"):
        walks = [(float(walk.get("duration", -1)), float(walk.get("arrival", -1))) for walk in person.iter("walk")]
        over = bool(walks) and all(arrival_s >= 0.0 for _, arrival_s in walks)
        walks_s[person.attrib["id"]] = sum(duration_s for duration_s, _ in walks) if over else None
    return Trips(vehicles, walks_s)


def _trip(each: ET.Element) -> Trip:
    found = each.find("emissions")
    emitted = {} if found is None else {name: float(value) for name, value in found.attrib.items()}
    delay_s = float(each.attrib["departDelay"])
    return Trip(
        wanted_s=float(each.attrib["depart"]) - delay_s,
        delay_s=delay_s,
        duration_s=float(each.attrib["duration"]),
        loss_s=float(each.attrib["timeLoss"]),
        length_m=float(each.attrib["routeLength"]),
        co2_kg=emitted.get("CO2_abs", 0.0) / MG_PER_KG,
        nox_g=emitted.get("NOx_abs", 0.0) / 1000.0,
        pm_g=emitted.get("PMx_abs", 0.0) / 1000.0,
        fuel_kg=emitted.get("fuel_abs", 0.0) / MG_PER_KG,
        electricity_kwh=emitted.get("electricity_abs", 0.0) / 1000.0,
        arrived=float(each.attrib.get("arrival", -1)) >= 0.0,
    )
