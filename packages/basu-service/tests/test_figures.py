"""Claims about the figures of a service: falls, headways, connections, the document, and the comparison in pairs."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.metrics.json_schema import schema_of
from basu.output.report.documents import mistakes
from basu_service.compare_command import comparison, services_in
from basu_service.console import table
from basu_service.demand import Connection
from basu_service.document import ServiceDocument, read_service, schema_text, service_schema, write_service
from basu_service.falls import Stander, falls, of_hundred, threshold_mps2
from basu_service.figures import connection_of, connections
from basu_service.operator import Trace
from basu_service.page import PAGE_FILE, write_page
from point_service import NeverStops, Played, demand, honest, play

SCHEMA = Path(__file__).parents[1] / "src" / "basu_service" / "data" / "service.schema.json"
INCIDENT_MPS2, GENTLE_MPS2 = (
    3.73,
    0.89,
)  # the strongest pushes of the incident and of basic: docs/reference/passengers.md


def test_most_standing_passengers_lose_balance_in_the_incident_and_none_in_a_gentle_ride() -> None:
    for holds_on, least in ((False, 90), (True, 75)):
        found = of_hundred(INCIDENT_MPS2, holds_on=holds_on)
        assert found.low <= found.value <= found.high <= 100
        assert found.low >= least
        calm = of_hundred(GENTLE_MPS2, holds_on=holds_on)
        assert calm.value < 1.0
        assert calm.high <= 3.0


def test_falls_grow_with_the_push_and_a_hand_at_the_pole_helps() -> None:
    free = [of_hundred(0.5 * step, holds_on=False).value for step in range(1, 11)]
    assert free == sorted(free)
    assert all(of_hundred(0.5 * step, holds_on=True).value <= free[step - 1] for step in range(1, 11))
    assert threshold_mps2(True, 0.5) == pytest.approx((2.26 * 2.65) ** 0.5)
    assert of_hundred(0.0, holds_on=False).high == 0.0


def test_the_count_of_falls_is_that_of_single_persons() -> None:
    assert falls([]).standing == 0
    steady, shaky = Stander(True, 0.99, 2.5), Stander(True, 0.01, 2.5)
    assert (falls([steady]).value, falls([shaky]).value) == (0.0, 1.0)
    many = falls([Stander(False, (n + 0.5) / 100, INCIDENT_MPS2) for n in range(100)])
    assert many.value == pytest.approx(of_hundred(INCIDENT_MPS2, holds_on=False).value, abs=1.0)
    assert many.low <= many.value <= many.high


def test_a_late_rider_misses_the_connection_that_the_timetable_promised() -> None:
    played = play(honest(), holds=True, wanted=demand(6.0))
    journey = next(each for each in played.service.journeys if each.alighted_s is not None)
    person = replace(journey.person, connects=True)
    promised_s = played.plan.promised_arrival_s(person.stop_id, person.destination_id, person.came_s)
    assert promised_s is not None
    begins_s = played.plan.timetable.run_departure_s
    line = Connection(name="X", every_s=600.0, first_s=begins_s + promised_s + 100.0, walk_s=60.0, share=1.0)
    wanted = replace(played.operated.demand, connections={person.destination_id: line})
    operated = played.operated._replace(demand=wanted)

    def made(alighted_s: float | None, *, connects: bool = True) -> bool | None:
        rider = replace(person, connects=connects)
        return connection_of(replace(journey, person=rider, alighted_s=alighted_s), operated)

    assert made(promised_s + 40.0) is True  # 40 s late and 60 s on foot: the departure is 100 s after the promise
    assert made(promised_s + 41.0) is False
    assert made(None) is None
    assert made(promised_s + 41.0, connects=False) is None
    late = [replace(each, person=replace(each.person, connects=True)) for each in played.service.journeys]
    played.service.journeys[:] = late
    counted = connections(operated)
    going = [
        each for each in late if each.person.destination_id == person.destination_id and each.alighted_s is not None
    ]
    assert counted["made"] + counted["missed"] == len(going) > 1


def test_headways_of_a_regular_service_are_the_planned_ones() -> None:
    ways = play(honest(), holds=True, wanted=demand(0.5)).document["headways"]
    assert ways["mean_s"] == pytest.approx(600.0, abs=15.0)
    assert ways["planned_s"] == 600.0
    assert ways["variation"] is not None
    assert ways["variation"] < 0.06
    assert ways["bunched"] == 0.0
    close = play(honest(), apart_s=120.0, wanted=demand(0.5)).document["headways"]
    assert close["bunched"] is not None
    assert close["bunched"] > 0.4
    assert close["variation"] is not None
    assert close["variation"] > 0.5


@pytest.fixture
def played() -> Played:
    return play(honest(), wanted=demand(10.0))


def test_the_document_is_as_its_schema_says_and_is_read_back(played: Played, tmp_path: Path) -> None:
    assert SCHEMA.read_text(encoding="utf-8") == schema_text()
    assert list(mistakes(played.document, service_schema())) == []
    assert schema_of(ServiceDocument)["required"] == list(played.document)
    write_service(tmp_path, played.document)
    assert read_service(tmp_path) == played.document
    spoilt = {**played.document, "passed": "yes"}
    (tmp_path / "service.json").write_text(json.dumps(spoilt), encoding="utf-8")
    with pytest.raises(UserError, match="passed"):
        read_service(tmp_path)
    with pytest.raises(UserError, match="basu service run"):
        read_service(tmp_path / "nowhere")


def test_table_and_page_show_the_figures(played: Played, tmp_path: Path) -> None:
    text = table(played.document)
    assert "persons" in text
    assert "standing passengers lose balance" in text
    trace = [Trace(float(second), 5.0 * second % played.plan.length_m) for second in range(3600)]
    write_page(tmp_path, played.document, played.plan, [trace, trace])
    page = (tmp_path / PAGE_FILE).read_text(encoding="utf-8")
    assert page.count("<polyline") == 2 * 5
    assert "passenger-km" in page


def test_a_comparison_takes_pairs_only(played: Played, tmp_path: Path) -> None:
    def written(name: str, *documents: ServiceDocument) -> Path:
        for number, document in enumerate(documents):
            folder = tmp_path / name / str(number)
            folder.mkdir(parents=True)
            write_service(folder, document)
        return tmp_path / name

    others = [play(honest(), seed=seed).document for seed in (2, 3)]
    foul = [play([NeverStops(), NeverStops()], seed=seed).document for seed in (2, 3)]
    first, second = services_in(written("a", *others)), services_in(written("b", *foul))
    text = comparison(["honest", "never"], first, second)
    assert "2 seeds" in text
    assert "A higher 0, B higher 2" in text
    assert "only 2 seeds" in text
    with pytest.raises(UserError, match="the seeds differ"):
        comparison(["a", "b"], first, {1: played.document})
    shorter = {seed: play(honest(), seed=seed, minutes=30.0).document for seed in (2, 3)}
    with pytest.raises(UserError, match=r"no pair: minutes is 60\.0 and 30\.0"):
        comparison(["a", "b"], first, shorter)
    with pytest.raises(UserError, match="two services with the seed 2"):
        services_in(written("c", others[0], others[0]))
    with pytest.raises(UserError, match="name the --output"):
        services_in(tmp_path / "nowhere")
