"""Would its passengers have stood the ride? Pass or fail with reasons, and every figure behind it.

A ride fails for harm: any contact, a near miss, a rule of the road that was broken, a service stop that was passed, and
a route that was not driven to its end. It fails when a standing passenger could have been thrown: by a harsh
stop of any cause, or by any push above what volunteers recovered from with a step. It fails for shaking that people
call uncomfortable. Delays and single balancing steps lower the comfort score and fail no ride.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basu.metrics.collisions import collisions
from basu.metrics.lanes import against_route, in_oncoming_lane, off_road
from basu.metrics.passengers.causes import Cause, StopCause, cause
from basu.metrics.passengers.comfort_score import (
    ComfortWeights,
    Harm,
    Vibration,
    comfort_score,
    on_the_move_mps2,
    parts,
    reactions,
    vibration,
)
from basu.metrics.passengers.felt import GRIP_MPS2, STANDING, Balance, Felt, PassengerPlace, balance, felt
from basu.metrics.passengers.harsh_stops import HARSH_MPS2, HarshStop, harsh_stops
from basu.metrics.passengers.near_misses import Party, near_misses
from basu.metrics.passengers.service import Visit, fault_of, service, time_to_board
from basu.metrics.path_following import PARKED_M, arc_length_m, completion
from basu.metrics.red_lights import red_lights
from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.speeding import speeding
from basu.metrics.stop_signs import stop_signs
from basu.metrics.stretches import path_m
from basu.metrics.validity import validity

if TYPE_CHECKING:
    from basu.metrics.infraction import Evidence
    from basu.records.history import History

UNCOMFORTABLE_MPS2 = 0.8  # where "uncomfortable" begins, ISO 2631-1 annex C.2.3


@dataclass(frozen=True, slots=True, kw_only=True)
class PassengerJudgement:
    """All that the passengers have to say."""

    place: PassengerPlace
    harsh_mps2: float  # from which on a braking is a harsh stop
    felt: Felt
    balance: Balance
    stops: tuple[tuple[HarshStop, Cause], ...]
    vibration: Vibration
    parties: tuple[Party, ...]
    visits: tuple[Visit, ...]
    contacts: tuple[Evidence, ...]
    breaches: tuple[Evidence, ...]  # rules of the road that were broken
    harm: Harm
    parts: dict[str, float]
    weights: ComfortWeights
    comfort: float | None
    reasons: tuple[str, ...]  # why the ride failed; none where it passed

    @property
    def passed(self) -> bool:
        """Whether there is nothing against the ride."""
        return not self.reasons


def judge(
    history: History,
    weights: ComfortWeights | None = None,
    place: PassengerPlace = STANDING,
    harsh_mps2: float = HARSH_MPS2,
    *,
    tolerance_mps: float = TOLERANCE_MPS,
    ended_early: bool = False,
) -> PassengerJudgement | None:
    """Judge a ride as a passenger standing at ``place``; None for a record too short to feel anything.

    ``tolerance_mps`` is of speeding. ``ended_early`` says that the benchmark ended the drive before the end of its
    route because all that it asks for was driven, as at the end of a scenario.
    """
    sensed = felt(history, place)
    if sensed is None:
        return None
    weights = weights or ComfortWeights()
    upright, shaken = balance(sensed), vibration(sensed)
    stops = tuple((stop, cause(history, stop)) for stop in harsh_stops(sensed, harsh_mps2))
    parties, visits = near_misses(history), service(history)
    contacts, breaches = collisions(history), _breaches(history, tolerance_mps)
    phantom = [why.kind is StopCause.NOTHING for _, why in stops]
    harm = Harm(
        contacts=len(contacts),
        completion=float(_went(history)) if ended_early else completion(history),
        near_misses=sum(party.is_near_miss for party in parties),
        rules_broken=len(breaches),
        stops_passed=sum(not time_to_board(visit) for visit in visits),
        phantom_stops=sum(phantom),
    )
    shaken_mps2 = on_the_move_mps2(shaken, sensed, upright)
    measured = parts(upright, phantom, shaken_mps2, harm, visits)
    return PassengerJudgement(
        place=place,
        harsh_mps2=harsh_mps2,
        felt=sensed,
        balance=upright,
        stops=stops,
        vibration=shaken,
        parties=parties,
        visits=visits,
        contacts=contacts,
        breaches=breaches,
        harm=harm,
        parts=measured,
        weights=weights,
        comfort=comfort_score(measured, weights, harm),
        reasons=(
            *(f"collision at {found.t_s:.1f} s: {found.detail}" for found in contacts),
            *(f"near miss: {party.detail}" for party in parties if party.is_near_miss),
            *_rules_and_service(history, harm, breaches, visits),
            *_pushes(upright, stops, shaken_mps2),
        ),
    )


def _breaches(history: History, tolerance_mps: float) -> tuple[Evidence, ...]:
    """The rules of the road that were broken, in order of time."""
    found = (
        *red_lights(history),
        *stop_signs(history),
        *speeding(history, tolerance_mps),
        *off_road(history),
        *(replace(each, detail=f"in a lane of oncoming traffic {each.detail}") for each in in_oncoming_lane(history)),
        *against_route(history),
    )
    return tuple(sorted(found, key=lambda each: (each.tick, each.kind.value)))


def _went(history: History) -> bool:
    """Whether the vehicle drove at all: standing still earns no comfort."""
    return arc_length_m(path_m(history.frames)) > PARKED_M


def _rules_and_service(
    history: History, harm: Harm, breaches: tuple[Evidence, ...], visits: tuple[Visit, ...]
) -> list[str]:
    """Sentences about broken rules, stops that were passed, and a route that was not driven to its end."""
    found = [f"rule broken at {each.t_s:.1f} s: {each.detail}" for each in breaches]
    reached_m = float(history.frames["route_s_m"].max())
    place_m = {stop.id: stop.s_m for stop in history.facts.route.stops}
    found.extend(
        f"the service stop '{visit.name}' {fault_of(visit)}"
        for visit in visits
        if not time_to_board(visit) and place_m[visit.stop_id] <= reached_m
    )
    if not _went(history):
        found.append("the vehicle stood: a ride that goes nowhere earns no comfort")
    elif harm.completion < 1.0 and (gaps := validity(history).gaps):
        pieces = ", ".join(f"{gap.from_s_m:.0f} to {gap.to_s_m:.0f} m" for gap in gaps)
        found.append(f"the route was not driven from {pieces}")
    elif harm.completion < 1.0:
        found.append(f"the ride ended after {reached_m:.0f} m of its {history.facts.route.length_m:.0f} m")
    return found


def _pushes(upright: Balance, stops: tuple[tuple[HarshStop, Cause], ...], shaken_mps2: float) -> list[str]:
    """Sentences about harsh stops, strong pushes and shaking."""
    found = [
        f"{'phantom' if why.kind is StopCause.NOTHING else 'harsh'} stop at {stop.t_s:.1f} s "
        f"from {stop.from_mps:.2f} m/s, up to {stop.strongest_mps2:.2f} m/s²: {why.detail}"
        for stop, why in stops
    ]
    if upright.grip_s > 0.0:
        found.append(
            f"for {upright.grip_s:.2f} s pushed by more than {GRIP_MPS2} m/s², up to {upright.worst_mps2:.2f} at "
            f"{upright.worst_t_s:.1f} s: a standing passenger without a handhold may fall"
        )
    if shaken_mps2 >= UNCOMFORTABLE_MPS2:
        found.append(f"shaken by {shaken_mps2:.2f} m/s² on the move: {' or '.join(reactions(shaken_mps2))}")
    return found
