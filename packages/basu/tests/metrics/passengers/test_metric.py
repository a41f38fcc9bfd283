"""Claims about what the console tells of the passengers."""

from dataclasses import replace

from basu.metrics.passengers.metric import Passengers
from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.records.history import History
from basu.routing import Stop
from basu.routing.timetable import Call, Hours, Timetable
from fakes.drives import straight_route
from fakes.rides import braked, eastward, ride

DONE = Outcome(Status.SCENARIO_ENDED, "over")


def felt(history: History | None) -> list[str]:
    return Passengers().lines(judge(DONE, history))


def test_a_phantom_stop_is_reported_with_its_reason() -> None:
    lines = felt(ride(30.0, eastward(braked(3.17, 5.0, 3.5), 30.0)))
    assert lines[0].startswith("passengers        failed, comfort score 0.")
    assert lines[1].strip().startswith("phantom stop at 5.0 s from 3.17 m/s")


def test_how_the_timetable_was_kept_is_an_answer() -> None:
    stops = tuple(Stop(id=i, name=i, s_m=s, x_m=s, y_m=0.0, z_m=0.0, yaw_rad=0.0) for i, s in (("A", 0.0), ("B", 50.0)))
    timetable = Timetable(
        round_s=600.0,
        headway_s=600.0,
        service=(Hours(days=("Mon",), from_s=0.0, to_s=3600.0),),
        run_day="Mon",
        run_departure_s=0.0,
        calls=(
            Call(stop_id="A", arrival_s=0.0, departure_s=1.0),
            Call(stop_id="B", arrival_s=200.0, departure_s=210.0),
        ),
    )
    route = replace(straight_route(stops=stops), timetable=timetable)
    result = judge(DONE, ride(30.0, eastward(lambda t: 0.0 if t < 1.0 or t > 11.0 else 5.0, 31.0), route=route))
    comfortable, on_time = Passengers().answers(result)
    assert comfortable.question == "comfortable"
    assert (on_time.question, on_time.sentence) == ("on time", "no: 1 of 2 stops, up to 189 s early")


def test_of_a_moment_nothing_is_reported() -> None:
    assert felt(ride(0.1, eastward(lambda _: 1.0, 1.0))) == []
    assert felt(None) == []
