"""The result of a service as lines for the console, which the page shows too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.report.event_rates import rate_text

if TYPE_CHECKING:
    from basu_service.document import ServiceDocument, VehiclePart

WIDTH = 18


def facts(document: ServiceDocument) -> list[tuple[str, str]]:
    """Return the figures of a service, each with its name."""
    return [
        ("service", "passed" if document["passed"] else "failed"),
        ("hours", _hours(document)),
        *_of_persons(document),
        ("headways", _headways(document)),
        ("on time", _share(document["on_time"])),
        ("rides", _rides(document)),
        ("falls", _falls(document)),
        *((f"vehicle {vehicle['number']}", _vehicle(vehicle)) for vehicle in document["vehicles"]),
        *_events(document),
        *(("because" if number == 0 else "", why) for number, why in enumerate(document["reasons"])),
    ]


def _hours(document: ServiceDocument) -> str:
    lasted = f"{document['lasts_s'] / 60:.1f} of {document['minutes']:g} min"
    return f"{document['begins']}, {lasted}, seed {document['seed']}, holding: {document['holding']}"


def _of_persons(document: ServiceDocument) -> list[tuple[str, str]]:
    people, waits, links = document["persons"], document["waits"], document["connections"]
    ends = ("carried", "riding", "stranded", "waiting")
    counts = ", ".join(f"{people[end]} {end}" for end in ends)  # type: ignore[literal-required]
    return [
        ("persons", f"{people['came']} came: {counts}, {people['gave_up']} gave up"),
        ("left behind", f"{people['left_behind']} times; carried past: {people['carried_past']} times"),
        ("wait", f"{_minutes(waits['mean_s'])} on average of all, longest {_minutes(waits['longest_s'])}"),
        ("connections", f"{links['made']} made, {links['missed']} missed"),
    ]


def _headways(document: ServiceDocument) -> str:
    ways = document["headways"]
    mean = f"{ways['count']}, mean {_minutes(ways['mean_s'])} (planned {_minutes(ways['planned_s'])})"
    spread = f"variation {_figure(ways['variation'])}, bunched {_share(ways['bunched'])}"
    return f"{mean}, {spread}, longest gap {_minutes(ways['longest_gap_s'])}"


def _rides(document: ServiceDocument) -> str:
    rides = document["rides"]
    most = f"at most {rides['most_aboard']}, at most {rides['most_standing']} standing"
    way = f"{_minutes(rides['mean_s'])} on average, {rides['passenger_km']:.1f} passenger-km"
    return f"{way}, {rides['mean_aboard']:.1f} aboard, {most}"


def _falls(document: ServiceDocument) -> str:
    falls = document["falls"]
    model = f"model: {falls['low']:.0f} to {falls['high']:.0f}"
    count = f"{falls['expected']:.0f} of {falls['standing']} standing passengers lose balance ({model})"
    return f"{count}, strongest push {falls['strongest_mps2']:.2f} m/s²"


def _events(document: ServiceDocument) -> list[tuple[str, str]]:
    """Return the events of all vehicles for the distance that they have driven."""
    vehicles = document["vehicles"]
    driven_m = sum(each["driven_m"] for each in vehicles)
    counted = ("contacts", "infractions", "disengagements")
    return [(name, rate_text(sum(each[name] for each in vehicles), driven_m)) for name in counted]  # type: ignore[literal-required]


def _vehicle(vehicle: VehiclePart) -> str:
    way = f"{vehicle['driven_m']:.0f} m, {vehicle['calls']} calls, {vehicle['passed']} passed"
    dwell = f"dwell {_seconds(vehicle['dwell_mean_s'])}, comfort {_figure(vehicle['comfort_score'])}"
    counted = ("harsh_stops", "contacts", "infractions", "disengagements")
    events = ", ".join(f"{name.replace('_', ' ')} {vehicle[name]}" for name in counted)  # type: ignore[literal-required]
    return f"{vehicle['agent']}, {vehicle['status']}: {way}, {dwell}, {events}"


def table(document: ServiceDocument) -> str:
    """Return the figures of a service as lines of text."""
    return "\n".join(f"{name:<{WIDTH}}{value}" for name, value in facts(document))


def _minutes(value_s: float | None) -> str:
    return "-" if value_s is None else f"{value_s / 60:.1f} min"


def _seconds(value_s: float | None) -> str:
    return "-" if value_s is None else f"{value_s:.0f} s"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.0f} %"


def _figure(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
