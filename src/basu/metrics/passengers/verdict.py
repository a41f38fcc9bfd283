"""Would its passengers have stood the ride? Pass or fail with reasons, and every figure behind it.

A ride fails when somebody who stands could have been thrown: by a harsh stop, whatever its cause, or by any push above
what volunteers recovered from with a step. It fails for a near miss, and for shaking that people call uncomfortable.
Being late, or having to take a step now and then, lowers the comfort score but fails nobody.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from basu.metrics.passengers.balance import GRIP_MPS2, Balance, balance
from basu.metrics.passengers.causes import Cause, Kind, cause
from basu.metrics.passengers.comfort_score import ComfortWeights, comfort_score, parts
from basu.metrics.passengers.felt import STANDING, Felt, Place, felt
from basu.metrics.passengers.harsh_stops import HARSH_MPS2, HarshStop, harsh_stops
from basu.metrics.passengers.near_misses import Party, near_misses
from basu.metrics.passengers.service import Visit, service
from basu.metrics.passengers.vibration import Vibration, vibration

if TYPE_CHECKING:
    from basu.records.history import History

UNCOMFORTABLE_MPS2 = 0.8  # where "uncomfortable" begins, ISO 2631-1 annex C.2.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """All that the passengers have to say."""

    place: Place
    harsh_mps2: float  # from which on a braking is a harsh stop
    felt: Felt
    balance: Balance
    stops: tuple[tuple[HarshStop, Cause], ...]
    vibration: Vibration
    parties: tuple[Party, ...]
    visits: tuple[Visit, ...]
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
    place: Place = STANDING,
    harsh_mps2: float = HARSH_MPS2,
) -> Judged | None:
    """Judge a ride as somebody standing at ``place``; None for a record too short to feel anything."""
    sensed = felt(history, place)
    if sensed is None:
        return None
    weights = weights or ComfortWeights()
    upright, shaken = balance(sensed), vibration(sensed)
    stops = tuple((stop, cause(history, stop)) for stop in harsh_stops(sensed, harsh_mps2))
    parties, visits = near_misses(history), service(history)
    measured = parts(upright, [why.kind is Kind.NOTHING for _, why in stops], shaken, parties, visits)
    return Judged(
        place=place,
        harsh_mps2=harsh_mps2,
        felt=sensed,
        balance=upright,
        stops=stops,
        vibration=shaken,
        parties=parties,
        visits=visits,
        parts=measured,
        weights=weights,
        comfort=comfort_score(measured, weights),
        reasons=_reasons(upright, stops, shaken, parties),
    )


def _reasons(
    upright: Balance, stops: tuple[tuple[HarshStop, Cause], ...], shaken: Vibration, parties: tuple[Party, ...]
) -> tuple[str, ...]:
    """Everything against the ride, a sentence each."""
    found = [
        f"{'phantom' if why.kind is Kind.NOTHING else 'harsh'} stop at {stop.t_s:.1f} s from {stop.from_mps:.2f} m/s, "
        f"up to {stop.strongest_mps2:.2f} m/s²: {why.detail}"
        for stop, why in stops
    ]
    if upright.grip_s > 0.0:
        found.append(
            f"for {upright.grip_s:.2f} s pushed by more than {GRIP_MPS2} m/s², up to {upright.worst_mps2:.2f} at "
            f"{upright.worst_t_s:.1f} s: who holds on to nothing may fall"
        )
    found.extend(f"near miss: {party.detail}" for party in parties if party.is_near_miss)
    if shaken.total_mps2 >= UNCOMFORTABLE_MPS2:
        found.append(f"shaken by {shaken.total_mps2:.2f} m/s²: {' or '.join(shaken.reactions)}")
    return tuple(found)
