"""A service of vehicles that are points on a round, each with a driver of a few lines; no simulator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from basu.agents.builtin.cooperation.headways import Headways
from basu.metrics.result import Result, judge
from basu.outcome import Outcome, Status
from basu.routing.route_file import RouteDescription, RoutePoint, StopMark
from basu.routing.timetable import Call, Hours, Timetable
from basu_service.demand import Demand, Rate, Shares, StopDemand
from basu_service.document import ServiceDocument
from basu_service.figures import Operated
from basu_service.operation import Seen, Service
from basu_service.persons import draw_persons
from basu_service.plan import ServicePlan, make_plan
from basu_service.result import service_document

SIDE_M = 900.0
ROUND_M = 4.0 * SIDE_M
STOPS = ("A", "B", "C", "D")
STEP_S = 0.5
SPEED_MPS, DWELL_S = 5.0, 10.0
ALL_DAY = (Hours(days=("Mon",), from_s=0.0, to_s=86_400.0),)


def timetable(round_s: float = 1200.0) -> Timetable:
    leg_s = round_s / len(STOPS)
    calls = tuple(Call(stop_id=name, arrival_s=n * leg_s, departure_s=n * leg_s + 20.0) for n, name in enumerate(STOPS))
    return Timetable(
        round_s=round_s, headway_s=600.0, service=ALL_DAY, run_day="Mon", run_departure_s=36_000.0, calls=calls
    )


def square(times: Timetable | None = None) -> RouteDescription:
    """A round of four stops, one at each corner."""
    corners = [(0.0, 0.0), (SIDE_M, 0.0), (SIDE_M, SIDE_M), (0.0, SIDE_M)]
    points = tuple(RoutePoint(x_m, y_m, 0.0) for x_m, y_m in [*corners, corners[0]])
    stops = tuple(StopMark(id=name, name=name, point=points[n]) for n, name in enumerate(STOPS))
    return RouteDescription(
        id="square", town="Nowhere", points=points, stops=stops, source="square.xml", timetable=times or timetable()
    )


def demand(per_hour: float = 10.0, shares: Shares | None = None) -> Demand:
    stops = tuple(
        StopDemand(
            stop_id=name,
            rates=(Rate(from_s=0.0, to_s=86_400.0, per_hour=per_hour),),
            destinations=tuple((other, 1.0 / (len(STOPS) - 1)) for other in STOPS if other != name),
        )
        for name in STOPS
    )
    usual = Shares(wheelchair=0.03, pushchair=0.05, needs_seat=0.15, stands=0.1, holds_on=0.8)
    return Demand(stops=stops, shares=shares or usual, patience_s=1800.0, connections={}, source="square.json")


@dataclass
class Driver:
    """An honest driver: rests at each stop for ten seconds, and longer while it is held."""

    speed_mps: float = SPEED_MPS
    place_m: float = 0.0
    rested_s: float = 0.0
    served: str | None = None  # the stop that it has left last
    held_s: float = 0.0
    dies_s: float = float("inf")

    def stop_here(self) -> str | None:
        for number, name in enumerate(STOPS):
            if abs((self.place_m - number * SIDE_M + 0.5 * ROUND_M) % ROUND_M - 0.5 * ROUND_M) <= 2.0:
                return name
        return None

    def rests(self, stop: str | None) -> bool:
        return stop is not None and stop != self.served

    def is_done(self) -> bool:
        return self.rested_s >= DWELL_S + self.held_s


class NeverStops(Driver):
    def rests(self, stop: str | None) -> bool:
        return False


class StandsForEver(Driver):
    def is_done(self) -> bool:
        return False


class LeavesAtOnce(Driver):
    """Wants to go on as soon as the stop counts as served."""

    def is_done(self) -> bool:
        return self.rested_s >= 1.0


class StopsHalfASecond(Driver):
    """Rests for less than the doors need to begin, with its own doors open all the time."""

    def is_done(self) -> bool:
        return self.rested_s >= STEP_S


@dataclass
class Played:
    plan: ServicePlan
    service: Service
    operated: Operated
    document: ServiceDocument
    most_aboard: int
    boarded_moving: list[int]


class Round:
    """The vehicles of one service on the round."""

    def __init__(
        self, plan: ServicePlan, service: Service, drivers: Sequence[Driver], rng: np.random.Generator
    ) -> None:
        self.plan, self.service, self.drivers, self.rng = plan, service, drivers, rng
        self.views = [Headways(dict(plan.places_m), plan.length_m) for _ in drivers]
        self.speeds_mps = [driver.speed_mps for driver in drivers]
        self.parked = [False] * len(drivers)
        self.before: list[str | None] = [None] * len(drivers)  # the stop of the step before
        self.most_aboard, self.boarded_moving = 0, list[int]()

    def step(self, t_s: float, number: int, slower: float, *, cooperates: bool) -> None:
        driver, service = self.drivers[number], self.service
        stop = driver.stop_here()
        if stop is None:
            left = self.before[number]
            if left is not None and driver.served != left:
                service.has_passed(t_s, number, left)
            driver.served, driver.rested_s = None, 0.0
        self.before[number] = stop
        rests = driver.rests(stop)
        goes = not rests or driver.is_done()
        moves = not self.parked[number] and goes
        boarded = self._boarded()
        self.parked[number] = service.step(t_s, number, Seen(stop, not moves, goes))
        if moves and self._boarded() > boarded:
            self.boarded_moving.append(number)
        self.most_aboard = max(self.most_aboard, len(service._vehicles[number].cabin.aboard))
        if rests and driver.rested_s == 0.0 and cooperates:
            self._cooperate(t_s, number, str(stop))
        driver.rested_s += STEP_S if rests else 0.0
        if not self.parked[number] and moves:
            self._move(t_s, number, stop if rests else None, slower)

    def _boarded(self) -> int:
        return sum(journey.boarded_s is not None for journey in self.service.journeys)

    def _cooperate(self, t_s: float, number: int, stop: str) -> None:
        texts = [(str(other), view.text(t_s)) for other, view in enumerate(self.views) if other != number]
        self.views[number].hear([(name, text) for name, text in texts if text is not None], t_s)
        self.drivers[number].held_s = self.views[number].hold_s(stop, t_s + DWELL_S)

    def _move(self, t_s: float, number: int, leaves: str | None, slower: float) -> None:
        driver = self.drivers[number]
        if leaves is not None:
            self.views[number].left(leaves, t_s)
            driver.served = leaves
            self.speeds_mps[number] = driver.speed_mps * max(0.3, 1.0 + slower * float(self.rng.standard_normal()))
        driver.place_m = (driver.place_m + self.speeds_mps[number] * STEP_S) % ROUND_M


def play(
    drivers: Sequence[Driver],
    *,
    seed: int = 1,
    minutes: float = 60.0,
    wanted: Demand | None = None,
    holds: bool = False,
    apart_s: float | None = None,
    cooperates: bool = False,
    slower: float = 0.0,
    results: Callable[[int], Result] | None = None,
) -> Played:
    """Play a service; ``slower`` is the standard deviation of the speed on a leg, as a share."""
    plan = make_plan(square(), len(drivers), apart_s)
    wanted = wanted or demand()
    persons = draw_persons(wanted, seed, plan.timetable.run_departure_s, 60.0 * minutes)
    service = Service(persons, len(drivers), *((plan.planned_departure_s,) if holds else ()))
    for driver, start_m in zip(drivers, plan.starts_m, strict=True):
        driver.place_m = start_m
    round_ = Round(plan, service, drivers, np.random.default_rng(seed))
    for tick in range(int(60.0 * minutes / STEP_S)):
        for number, driver in enumerate(drivers):
            if tick * STEP_S < driver.dies_s:
                round_.step(tick * STEP_S, number, slower, cooperates=cooperates)
    service.finish(60.0 * minutes)
    ended = results or (lambda _: judge(Outcome(Status.STOPPED, "stopped as asked"), None))
    each = [ended(number) for number in range(len(drivers))]
    operated = Operated(plan, wanted, service, each, minutes, 60.0 * minutes)
    agents = [type(driver).__name__ for driver in drivers]
    document = service_document(operated, seed=seed, holds=holds, agents=agents, contacts_between=0)
    return Played(plan, service, operated, document, round_.most_aboard, round_.boarded_moving)


def dead(number: int) -> Result:
    """The first vehicle's agent failed, the others drove to the end."""
    if number == 0:
        return judge(Outcome(Status.AGENT_CRASHED, "the agent failed"), None)
    return judge(Outcome(Status.STOPPED, "stopped as asked"), None)


def honest(count: int = 2) -> list[Driver]:
    return [Driver() for _ in range(count)]
