"""``service.json``, the result of a service, as typed dicts, from which its schema follows; written and read back."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import TYPE_CHECKING, Annotated, Any, Literal

from typing_extensions import TypedDict

from basu.errors import UserError
from basu.files import read_json, write_bytes
from basu.metrics.json_schema import Value, closed, schema_of
from basu.metrics.result_parts import Amount, Count, Share
from basu.output.report.documents import mistakes

if TYPE_CHECKING:
    from pathlib import Path

SERVICE_FILE, SCHEMA_FILE, SCHEMA_VERSION = "service.json", "service.schema.json", 1
KindName = Literal["on_foot", "wheelchair", "pushchair"]
End = Literal["carried", "riding", "stranded", "waiting", "gave_up"]


@closed
class PersonsPart(TypedDict):
    """All persons that came; came = carried + riding + stranded + waiting + gave_up."""

    came: Count
    carried: Annotated[int, Value("alighted at their destination", low=0)]
    riding: Annotated[int, Value("aboard at the end", low=0)]
    stranded: Annotated[int, Value("aboard a vehicle that ended its drive before the service", low=0)]
    waiting: Annotated[int, Value("at a stop at the end", low=0)]
    gave_up: Count
    left_behind: Annotated[int, Value("times that a vehicle left or passed a stop without a waiting person", low=0)]
    carried_past: Annotated[int, Value("times that a destination was passed with the person aboard", low=0)]


@closed
class WaitsPart(TypedDict):
    """The waiting times of persons at stops, in s."""

    mean_s: Annotated[
        float | None, "of all persons, until they boarded, gave up, or the service ended: no person is left out"
    ]
    boarded_mean_s: Annotated[float | None, "of the persons that boarded"]
    boarded_p90_s: float | None
    longest_s: float | None


@closed
class HeadwaysPart(TypedDict):
    """Times between departures at one stop, of all stops together."""

    planned_s: Amount
    count: Count
    mean_s: float | None
    variation: Annotated[float | None, "coefficient of variation: standard deviation over mean"]
    bunched: Annotated[float | None, Value("share below half of the planned one", low=0, high=1)]
    longest_gap_s: Annotated[float, Value("without a departure at a stop, to the end of the service too", low=0)]


@closed
class RidesPart(TypedDict):
    """Rides of the persons that were carried."""

    mean_s: float | None
    passenger_km: Annotated[float, Value("of all rides, by the route", low=0)]
    mean_aboard: Annotated[float, Value("passengers in a vehicle, over time", low=0)]
    most_aboard: Count
    most_standing: Count


@closed
class ConnectionsPart(TypedDict):
    """Connections with other lines that riders had in mind, by the timetable."""

    made: Count
    missed: Count


@closed
class FallsPart(TypedDict):
    """Standing passengers that lost balance, by the model; low and high are its 95 % interval."""

    standing: Annotated[int, Value("passengers that stood for a while", low=0)]
    expected: Amount
    low: Amount
    high: Amount
    strongest_mps2: Annotated[float, Value("felt by a standing passenger", low=0)]


@closed
class VehiclePart(TypedDict):
    """One vehicle with its drive in short."""

    number: Annotated[int, Value(low=1)]
    agent: str
    status: str
    message: str
    driven_m: Amount
    calls: Count
    passed: Annotated[int, Value("stops passed without opening the doors", low=0)]
    dwell_mean_s: float | None
    boarded: Count
    comfort_score: Share | None
    harsh_stops: Count
    contacts: Count
    infractions: Count
    disengagements: Count


@closed
class CallPart(TypedDict):
    """One visit of a vehicle at a stop; times in s from the beginning."""

    vehicle: Annotated[int, Value(low=1)]
    stop: str
    arrival_s: Amount
    departure_s: float | None
    planned_departure_s: float | None
    held_s: Amount
    boarded: Count
    alighted: Count
    left_behind: Count


@closed
class JourneyPart(TypedDict):
    """One person; times in s from the beginning."""

    origin: str
    destination: str
    kind: KindName
    came_s: Amount
    boarded_s: float | None
    alighted_s: float | None
    gave_up_s: float | None
    vehicle: int | None
    stood_s: Amount
    left_behind: Annotated[list[str], "why a vehicle left without the person, each time"]
    end: End
    connection: Literal["made", "missed"] | None


@closed
class ServiceDocument(TypedDict):
    """The result of a service."""

    schema_version: Annotated[int, Value(low=SCHEMA_VERSION, high=SCHEMA_VERSION)]
    passed: bool
    reasons: Annotated[list[str], "why the service failed; none where it passed"]
    seed: int
    minutes: Annotated[float, Value("how long it was to last", low=0)]
    lasts_s: Annotated[float, Value("how long it lasted: shorter where all drives ended", low=0)]
    begins: Annotated[str, "day and time of the timetable"]
    holding: Literal["timetable", "none"]
    demand: Annotated[str, "file name"]
    persons: PersonsPart
    waits: WaitsPart
    headways: HeadwaysPart
    rides: RidesPart
    connections: ConnectionsPart
    falls: FallsPart
    on_time: Annotated[Share | None, "share of departures 60 s early to 300 s late"]
    contacts_between: Annotated[int, Value("contacts of two vehicles of the service", low=0)]
    vehicles: list[VehiclePart]
    calls: list[CallPart]
    journeys: list[JourneyPart]


def service_schema() -> dict[str, Any]:
    """Return the schema of ``service.json``."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": SERVICE_FILE,
        **schema_of(ServiceDocument),
    }


def schema_text() -> str:
    """Return the schema as it lies in the package."""
    return json.dumps(service_schema(), indent=2) + "\n"


def write_service(folder: Path, document: ServiceDocument) -> None:
    """Write the document into a run's folder.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_bytes(folder / SERVICE_FILE, (json.dumps(document, indent=1) + "\n").encode())


def read_service(folder: Path) -> ServiceDocument:
    """Read the document of a run's folder.

    Raises:
        UserError: there is none, or it is not as its schema says.
    """
    path = folder / SERVICE_FILE
    document = read_json(path, "the result of a service", "name a folder that `basu service run` has left")
    schema = json.loads((files("basu_service") / "data" / SCHEMA_FILE).read_text(encoding="utf-8"))
    for mistake in mistakes(document, schema):
        raise UserError(f"{path}: {mistake}; the file was changed, or left by another version")
    found: ServiceDocument = document
    return found
