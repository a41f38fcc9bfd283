"""Claims about the comparison with and without the shuttle: persons conserved, times by hand, assumptions, and ways."""

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError

sumo = pytest.importorskip("sumo", reason="the extra for SUMO is not installed")

from basu_service.assumptions import Assumptions, packaged_assumptions, read_assumptions  # noqa: E402 - after the skip
from basu_service.document import ServiceDocument  # noqa: E402
from basu_service.impact import MILE_KM, figures  # noqa: E402
from basu_service.ways import Door, Way, counted, draw_ways, write_with, write_without  # noqa: E402
from basu_service.without_command import impact_table  # noqa: E402
from basu_sumo.alone import Trip, Trips, play_alone, read_trips  # noqa: E402
from point_service import demand, honest, play  # noqa: E402

HERE = Door("ab", 20.0)
ASSUMED = read_assumptions(packaged_assumptions())
NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="200" y="0"/><node id="c" x="400" y="0"/></nodes>'
EDGES = "".join(
    f'<edge id="{way}" from="{way[0]}" to="{way[1]}" sidewalkWidth="2"/>' for way in ("ab", "bc", "cb", "ba")
)
STOPS = """<additional><busStop id="S1" lane="ab_1" startPos="90" endPos="102"/>
<busStop id="S4" lane="bc_1" startPos="90" endPos="102"/>
<vType id="car" vClass="passenger"/><vTypeDistribution id="traffic" vTypes="car" probabilities="1"/></additional>"""
CONFIG = """<configuration><input><net-file value="walk.net.xml"/><additional-files value="stops.add.xml"/></input>
</configuration>"""


@pytest.fixture(autouse=True)
def _one_sumo_a_test() -> Iterator[None]:
    """End the SUMO of a test that failed: a process holds one."""
    yield
    libsumo = pytest.importorskip("libsumo")
    if libsumo.simulation.isLoaded():
        libsumo.close()


@pytest.fixture(scope="module")
def street(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A street with pavements, two stops and no traffic."""
    place = tmp_path_factory.mktemp("street")
    (place / "n.nod.xml").write_text(NODES)
    (place / "e.edg.xml").write_text(f"<edges>{EDGES}</edges>")
    netconvert = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    command = [str(netconvert), "-n", "n.nod.xml", "-e", "e.edg.xml", "--walkingareas", "--crossings.guess"]
    subprocess.run([*command, "-o", "walk.net.xml"], cwd=place, check=True, capture_output=True)
    (place / "stops.add.xml").write_text(STOPS)
    (place / "street.sumocfg").write_text(CONFIG)
    return place / "street.sumocfg"


def trip(wanted_s: float, *, loss_s: float = 0.0, length_m: float = 1000.0) -> Trip:
    return Trip(wanted_s, 1.0, 100.0, loss_s, length_m, 0.2, 0.5, 0.1, 0.06, 0.0, arrived=True)


def journey(came_s: float, boarded_s: float | None, alighted_s: float | None, gave_up_s: float | None = None) -> Any:
    document = play(honest(), wanted=demand(1.0)).document
    return {
        **document["journeys"][0],
        "origin": "S1",
        "destination": "S4",
        "came_s": came_s,
        "boarded_s": boarded_s,
        "alighted_s": alighted_s,
        "gave_up_s": gave_up_s,
    }


@pytest.fixture(scope="module")
def document() -> ServiceDocument:
    """A service with a person of each end."""
    journeys = [
        journey(50.0, 60.0, 200.0),  # sets out in the warm-up
        journey(300.0, 400.0, 700.0),  # carried, walks without the shuttle
        journey(310.0, 400.0, 720.0),  # carried, drives without it
        journey(320.0, None, None, 900.0),  # gives up and walks
        journey(1500.0, None, None),  # still waits
    ]
    whole: ServiceDocument = {**play(honest(), wanted=demand(1.0)).document, "journeys": journeys}
    return whole


def ways(document: ServiceDocument) -> list[Way]:
    return [
        Way(number, HERE, HERE, HERE, HERE, each["came_s"] - 100.0, number == 2)
        for number, each in enumerate(document["journeys"])
    ]


def test_each_person_is_in_one_place_and_times_are_those_by_hand(document: ServiceDocument) -> None:
    with_ = Trips(
        {"trip0": trip(10.0), "trip1": trip(200.0, loss_s=30.0), "trip2": trip(1e9)},
        {f"to{number}": 110.0 for number in (1, 2, 3, 4)} | {"from1": 80.0, "from2": 90.0, "from3": 1000.0},
    )
    without = Trips(
        {"trip0": trip(10.0), "trip1": trip(200.0, loss_s=10.0), "trip2": trip(1e9), "car2": trip(240.0)},
        {"all1": 600.0, "all3": 800.0, "all4": 700.0},
    )
    found = figures(document, ways(document), with_, without, ASSUMED)
    persons = found["persons"]
    assert persons == {"came": 5, "warm_up": 1, "open": 1, "walked": 2, "drove": 1}
    assert persons["came"] == sum(persons[name] for name in ("warm_up", "open", "walked", "drove"))
    assert found["door_to_door_of_walkers_s"] == [(580.0 + 1680.0) / 2, (600.0 + 800.0) / 2]
    assert found["door_to_door_of_drivers_s"] == [600.0, 101.0 + ASSUMED.car_access_s]
    assert found["walk_off_plan_s"] == pytest.approx(10.0)
    assert found["others"]["trips"] == 1  # not that of the warm-up, nor that after the hours
    assert found["others"]["delay_s"] == [31.0, 11.0]
    assert found["cars_of_persons"]["km"] == 1.0
    shuttle = found["shuttle"]
    usd = shuttle["vehicle_h"] * (ASSUMED.vehicle_usd_per_h + ASSUMED.attendant_usd_per_h)
    usd += shuttle["kwh"] * ASSUMED.usd_per_kwh
    miles = document["rides"]["passenger_km"] / MILE_KM
    assert shuttle["usd_per_passenger_mile"] == pytest.approx(usd / miles)
    text = impact_table("agent", {1: found, 2: found})
    assert "5 persons" not in text
    assert "10 persons came: 2 set out in the warm-up, 2 were under way at the end" in text
    assert f"{usd / miles:.2f} USD" in text


def test_persons_reach_their_stop_when_the_service_has_them_come(
    document: ServiceDocument, street: Path, tmp_path: Path
) -> None:
    journeys = document["journeys"]
    drawn = draw_ways(street, journeys, ["S1", "S4"], ASSUMED, seed=4)
    assert drawn == draw_ways(street, journeys, ["S1", "S4"], ASSUMED, seed=4)
    assert drawn != draw_ways(street, journeys, ["S1", "S4"], ASSUMED, seed=5)
    write_with(tmp_path / "with.rou.xml", drawn, journeys, ASSUMED)
    write_without(tmp_path / "without.rou.xml", drawn, ASSUMED)
    for side in ("with", "without"):
        more = tmp_path / f"{side}.rou.xml"
        play_alone(street, tmp_path / side, seed=4, step_s=0.5, until_s=1600.0, latest_s=2500.0, more=more)
    with_, without = read_trips(tmp_path / "with"), read_trips(tmp_path / "without")
    for way in drawn:
        if not counted(way, ASSUMED):
            continue
        walk_s = with_.walks_s[f"to{way.number}"]
        assert walk_s is not None
        assert way.sets_out_s + walk_s == pytest.approx(journeys[way.number]["came_s"], rel=0.2)
        assert (f"car{way.number}" in without.vehicles) == way.drives
        assert (f"all{way.number}" in without.walks_s) == (not way.drives)


def test_every_assumption_has_its_source_and_a_wrong_one_is_a_sentence(tmp_path: Path) -> None:
    whole: dict[str, Any] = json.loads(packaged_assumptions().read_text(encoding="utf-8"))
    assert isinstance(read_assumptions(packaged_assumptions()), Assumptions)

    def refused(change: dict[str, Any], says: str) -> None:
        path = tmp_path / "changed.json"
        path.write_text(json.dumps({**whole, "values": {**whole["values"], **change}}), encoding="utf-8")
        with pytest.raises(UserError, match=says):
            read_assumptions(path)

    refused({"car_share": {"value": 1.5, "source": "ours"}}, "car_share .* is 1.5; it must be a number from 0 to 1")
    refused({"car_share": {"value": float("nan"), "source": "ours"}}, "car_share .* is nan")
    refused({"usd_per_kwh": {"value": 0.1, "source": ""}}, "usd_per_kwh .* has no source")
    refused({"pogo_share": {"value": 0.1, "source": "ours"}}, "other values than needed: pogo_share")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["one", "two", "--without"], "--without compares one agent"),
        (["one"], "a comparison needs two agents or folders"),
        (["one", "two", "--assume", "x.json"], "--assume goes with that"),
        (["basic", "--without", "--assume", "nowhere.json"], "nowhere.json"),
        (["basic", "--without", "--seeds", "1"], "at least 2 services"),
    ],
)
def test_bad_input_is_a_sentence(
    options: list[str], says: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["service", "compare", *options]) == 2
    assert says in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
