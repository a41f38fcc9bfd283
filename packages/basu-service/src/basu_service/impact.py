"""What a shuttle changes: SUMO plays the hours of a driven service with its shuttles and without them.

Both plays are SUMO alone, with one scenario, one seed and one length. With the shuttle, the vehicles follow the records
of the service, and persons walk to and from it. Without it the persons walk or drive all the way.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.errors import BasuError, UserError
from basu.files import read_json
from basu.jobs.job import After, JobOutcome, PlayerSpec
from basu.output.report.documents import write_json
from basu.output.report.shuttles import folder_of
from basu.records.history.files import read_history
from basu.simulator import linden_command
from basu_service.document import SERVICE_FILE, read_service
from basu_service.plan import stop_of
from basu_service.ways import counted, draw_ways, write_with, write_without
from basu_sumo.alone import DrivenElsewhere, Trip, Trips, play_alone, read_trips
from basu_sumo.scenario import RouteStop, Wanted, config_in, made_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from basu.jobs.job import Play
    from basu_service.assumptions import Assumptions
    from basu_service.document import ServiceDocument
    from basu_service.ways import Way

IMPACT_FILE = "impact.json"
SCHEMA_VERSION = 1
STEP_S = 0.2  # of SUMO: its drivers' reaction is 1 s
MILE_KM = 1.609344
WITH, WITHOUT = "with", "without"


class ImpactJob(NamedTuple):
    """A driven service for a worker."""

    service: Path
    output: Path  # the folder that its plays are written into


def impact_player(assumed: Assumptions) -> PlayerSpec:
    """Return the player of services that SUMO plays again."""
    return PlayerSpec(f"{__name__}:open_impacts", (assumed,))


@contextlib.contextmanager
def open_impacts(assumed: Assumptions) -> Iterator[Play]:
    """Play what the command sends; the answer is the document, or the sentence of what went wrong."""

    def play(job: ImpactJob) -> JobOutcome:
        try:
            return JobOutcome(impact_of(job.service, job.output, assumed))
        except BasuError as error:
            return JobOutcome(str(error), After.GO_ON)

    yield play


def impact_of(folder: Path, output: Path, assumed: Assumptions) -> dict[str, Any]:
    """Return the document of one service; one that ``output`` holds for the same input is taken as it is.

    Raises:
        UserError: the service cannot be read, or SUMO cannot play it.
        SimulatorError: SUMO failed.
    """
    document = read_service(folder)
    said = (folder / SERVICE_FILE).read_bytes() + json.dumps(asdict(assumed), sort_keys=True).encode()
    digest = hashlib.sha256(said).hexdigest()[:16]
    path = output / IMPACT_FILE
    if path.exists():
        kept: dict[str, Any] = read_json(path, "the impact of a service", "remove it and play again")
        if kept.get("input") == digest and kept.get("schema_version") == SCHEMA_VERSION:
            return kept
    config, stops = _scenario(folder, document)
    elsewhere = [_record(folder / folder_of(each["number"]), each["number"]) for each in document["vehicles"]]
    journeys, seed = document["journeys"], document["seed"]
    ways = draw_ways(config, journeys, stops, assumed, seed)
    played = {}
    for side in (WITH, WITHOUT):
        more = output / side / "persons.rou.xml"
        if side == WITH:
            write_with(more, ways, journeys, assumed)
        else:
            write_without(more, ways, assumed)
        play_alone(
            config,
            output / side,
            seed=seed,
            step_s=STEP_S,
            until_s=document["lasts_s"],
            latest_s=document["lasts_s"] + 60.0 * assumed.tail_min,
            elsewhere=elsewhere if side == WITH else (),
            more=more,
        )
        played[side] = read_trips(output / side)
    found = figures(document, ways, played[WITH], played[WITHOUT], assumed)
    impact = {"schema_version": SCHEMA_VERSION, "input": digest, "seed": seed, **found}
    write_json(path, impact)
    return impact


def _scenario(folder: Path, document: ServiceDocument) -> tuple[Path, list[str]]:
    """Return SUMO's scenario of the hours of a service, and the names of its stops."""
    facts = read_history(folder).facts
    stops: dict[str, RouteStop] = {}
    for stop in facts.route.stops:
        stops.setdefault(stop_of(stop.id), RouteStop(stop_of(stop.id), stop.name, stop.x_m, stop.y_m))
    hours, _, minutes = document["begins"].partition(" ")[2].partition(":")
    wanted = Wanted(hour=int(hours) + int(minutes) / 60.0, stops=tuple(stops.values()), has_riders=False)
    made = made_of(None, facts.route.town, document["seed"], linden_command(), wanted)
    return config_in(made, is_random=False), list(stops)


def _record(folder: Path, number: int) -> DrivenElsewhere:
    history = read_history(folder)
    frames, vehicle = history.frames, history.facts.vehicle
    return DrivenElsewhere(
        name=f"_shuttle_{number}",
        length_m=vehicle.front_m + vehicle.rear_m,
        width_m=vehicle.width_m,
        t_s=np.asarray(frames["t_s"]),
        x_m=np.asarray(frames["x_m"]),
        y_m=np.asarray(frames["y_m"]),
        yaw_rad=np.asarray(frames["yaw_rad"]),
        speed_mps=np.hypot(frames["velocity_x_mps"], frames["velocity_y_mps"]),
    )


def figures(
    document: ServiceDocument, ways: Sequence[Way], with_: Trips, without: Trips, assumed: Assumptions
) -> dict[str, Any]:
    """Return the figures of a pair of plays.

    Each person is in one place of ``persons``: came = warm_up + open + walked + drove.
    """
    persons = {"came": len(ways), "warm_up": 0, "open": 0, "walked": 0, "drove": 0}
    doors_s: dict[str, list[tuple[float, float]]] = {"walked": [], "drove": []}
    off_s = []
    for way in ways:
        if not counted(way, assumed):
            persons["warm_up"] += 1
            continue
        one_s, other_s = _with_s(document, way, with_), _without_s(way, without, assumed)
        if one_s is None or other_s is None:
            persons["open"] += 1
            continue
        mode = "drove" if way.drives else "walked"
        persons[mode] += 1
        doors_s[mode].append((one_s, other_s))
        walk_s = with_.walks_s[f"to{way.number}"]
        assert walk_s is not None, "the way was walked"
        off_s.append(abs(way.sets_out_s + walk_s - document["journeys"][way.number]["came_s"]))
    both = [*doors_s["walked"], *doors_s["drove"]]
    names = _others(document, with_, without, assumed)
    cars = [without.vehicles[f"car{way.number}"] for way in ways if f"car{way.number}" in without.vehicles]
    of_with, of_without = ([side.vehicles[name] for name in names] for side in (with_, without))
    return {
        "persons": persons,
        "door_to_door_s": _pair(both),
        "door_to_door_of_walkers_s": _pair(doors_s["walked"]),
        "door_to_door_of_drivers_s": _pair(doors_s["drove"]),
        "walk_off_plan_s": float(np.mean(off_s)) if off_s else None,
        "others": {
            "trips": len(names),
            "delay_s": [_delay_s(of_with), _delay_s(of_without)],
            WITH: totals(of_with),
            WITHOUT: totals(of_without),
        },
        "cars_of_persons": {"trips": len(cars), **totals(cars)},
        "shuttle": _shuttle(document, assumed),
    }


def _pair(values_s: Sequence[tuple[float, float]]) -> list[float] | None:
    return None if not values_s else [float(each) for each in np.mean(np.array(values_s), axis=0)]


def _with_s(document: ServiceDocument, way: Way, trips: Trips) -> float | None:
    """Return the time from door to door with the shuttle; None for a way that had no end."""
    journey = document["journeys"][way.number]
    leaves_s = journey["gave_up_s"] if journey["alighted_s"] is None else journey["alighted_s"]
    first_s, last_s = (trips.walks_s.get(f"{part}{way.number}") for part in ("to", "from"))
    if leaves_s is None or first_s is None or last_s is None:
        return None
    return leaves_s + last_s - way.sets_out_s


def _without_s(way: Way, trips: Trips, assumed: Assumptions) -> float | None:
    """Return the time from door to door without the shuttle; None for a way that had no end."""
    if not way.drives:
        return trips.walks_s.get(f"all{way.number}")
    car = trips.vehicles.get(f"car{way.number}")
    return None if car is None or not car.arrived else car.delay_s + car.duration_s + assumed.car_access_s


def _others(document: ServiceDocument, with_: Trips, without: Trips, assumed: Assumptions) -> list[str]:
    """Return the trips of the scenario that both plays have, from the warm-up to the end of the service."""
    begins_s, ends_s = 60.0 * assumed.warm_up_min, document["lasts_s"]
    return [
        name
        for name, trip in sorted(with_.vehicles.items())
        if name in without.vehicles and not name.startswith("car") and begins_s <= trip.wanted_s < ends_s
    ]


def _delay_s(trips: Sequence[Trip]) -> float | None:
    return float(np.mean([trip.delay_s + trip.loss_s for trip in trips])) if trips else None


def totals(trips: Sequence[Trip]) -> dict[str, float]:
    """Return kilometres, energy and emissions of trips."""
    return {
        "km": sum(trip.length_m for trip in trips) / 1000.0,
        "fuel_kg": sum(trip.fuel_kg for trip in trips),
        "electricity_kwh": sum(trip.electricity_kwh for trip in trips),
        "co2_kg": sum(trip.co2_kg for trip in trips),
        "nox_g": sum(trip.nox_g for trip in trips),
        "pm_g": sum(trip.pm_g for trip in trips),
    }


def _shuttle(document: ServiceDocument, assumed: Assumptions) -> dict[str, float | None]:
    """Return kilometres, energy and cost of the service."""
    km = sum(each["driven_m"] for each in document["vehicles"]) / 1000.0
    kwh, hours = km * assumed.shuttle_kwh_per_km, len(document["vehicles"]) * document["lasts_s"] / 3600.0
    usd = hours * (assumed.vehicle_usd_per_h + assumed.attendant_usd_per_h) + kwh * assumed.usd_per_kwh
    miles = document["rides"]["passenger_km"] / MILE_KM
    return {
        "km": km,
        "kwh": kwh,
        "vehicle_h": hours,
        "usd": usd,
        "passenger_miles": miles,
        "usd_per_passenger_mile": usd / miles if miles > 0.0 else None,
    }


def check_service_folders(folders: Sequence[Path]) -> None:
    """Check that services have what a play needs.

    Raises:
        UserError: a record is missing.
    """
    for folder in folders:
        if not (folder / "history.parquet").is_file():
            raise UserError(f"{folder} has no record of the drive, which SUMO needs to play the shuttle again")
