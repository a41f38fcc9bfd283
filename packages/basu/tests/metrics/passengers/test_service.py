"""Claims about the service: arrivals, dwells and headways against a timetable."""

from dataclasses import replace

import pytest

from basu.metrics.passengers.service import service
from basu.records.history import History
from basu.routing import Stop
from basu.routing.timetable import Call, Hours, Timetable
from fakes.drives import straight_route
from fakes.rides import eastward, ride

TIMETABLE = Timetable(
    round_s=1440.0,
    headway_s=720.0,
    service=(Hours(days=("Mon",), from_s=0.0, to_s=7200.0),),
    run_day="Mon",
    run_departure_s=0.0,
    calls=(Call(stop_id="A", arrival_s=10.0, departure_s=15.0), Call(stop_id="B", arrival_s=400.0, departure_s=420.0)),
)


def stop(stop_id: str, s_m: float) -> Stop:
    return Stop(id=stop_id, name=f"Stop {stop_id}", s_m=s_m, x_m=s_m, y_m=0.0, z_m=0.0, yaw_rad=0.0)


def history(*stops: Stop, timetable: Timetable | None = TIMETABLE) -> History:
    """At 5 m/s to x = 50 m by 10 s, at rest for 8 s, on to x = 100 m by 28 s, and there to stay."""

    def speed(t_s: float) -> float:
        return 5.0 if t_s < 10.0 or 18.0 <= t_s < 28.0 else 0.0

    route = replace(straight_route(stops=stops), timetable=timetable)
    return ride(40.0, eastward(speed, 40.0), route=route)


def test_a_stop_is_reported_with_its_arrival_dwell_delay_and_headway() -> None:
    (visit,) = service(history(stop("A", 50.0)))
    assert visit.served
    assert visit.arrival_s == pytest.approx(10.0, abs=0.06)
    assert visit.dwell_s == pytest.approx(8.0, abs=0.06)
    assert visit.delay_s == pytest.approx(0.0, abs=0.06)
    assert visit.headway_s == pytest.approx(720.0, abs=0.06)
    assert visit.on_time


def test_too_early_is_not_on_time() -> None:
    visit = service(history(stop("A", 50.0), stop("B", 100.0)))[1]
    assert visit.delay_s == pytest.approx(28.0 - 400.0, abs=0.06)
    assert visit.on_time is False
    assert (visit.departure_s, visit.dwell_s) == (None, None)  # it never moved on


@pytest.mark.parametrize(("planned_s", "on_time"), [(69.0, True), (71.0, False)])
def test_a_minute_early_is_still_on_time(planned_s: float, on_time: bool) -> None:  # noqa: FBT001
    call = Call(stop_id="A", arrival_s=planned_s, departure_s=planned_s)
    (visit,) = service(history(stop("A", 50.0), timetable=replace(TIMETABLE, calls=(call,))))
    assert visit.on_time is on_time


def test_a_stop_driven_past_is_not_served_and_not_on_time() -> None:
    (visit,) = service(history(stop("A", 75.0)))
    assert (visit.served, visit.on_time, visit.delay_s, visit.arrival_s) == (False, False, None, None)


def test_without_a_timetable_there_is_no_delay_but_a_dwell() -> None:
    (visit,) = service(history(stop("A", 50.0), timetable=None))
    assert (visit.planned_arrival_s, visit.delay_s, visit.headway_s, visit.on_time) == (None, None, None, None)
    assert visit.dwell_s == pytest.approx(8.0, abs=0.06)
