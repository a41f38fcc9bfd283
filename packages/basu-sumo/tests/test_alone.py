"""Claims about SUMO by itself: totals beside SUMO's own, a vehicle that was driven elsewhere, and the same bytes."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from basu_sumo.alone import DrivenElsewhere, play_alone, read_trips

STEP_S = 0.2


def slow(offset_m: tuple[float, float] = (0.0, 0.0), *, speed_mps: float = 2.0) -> DrivenElsewhere:
    """A vehicle that creeps from a to c ahead of the scenario's."""
    t_s = np.arange(0.0, 150.0, 0.05)
    x_m = 30.0 + speed_mps * t_s - offset_m[0]
    still = np.zeros(len(t_s))
    return DrivenElsewhere("_slow", 4.0, 2.0, t_s, x_m, still + 1.6 + offset_m[1], still, still + speed_mps)


def play(folder: Path, output: Path, *elsewhere: DrivenElsewhere, until_s: float = 60.0) -> None:
    config = folder / "small.sumocfg"
    play_alone(config, output, seed=3, step_s=STEP_S, until_s=until_s, latest_s=300.0, elsewhere=elsewhere)


def test_our_totals_are_those_of_sumo_s_own_file(folder: Path, tmp_path: Path) -> None:
    more = tmp_path / "more.rou.xml"
    trips = "".join(
        f'<trip id="more{nth}" type="traffic" depart="{3 * nth}" from="{way[0]}" to="{way[1]}"/>'
        for nth, way in enumerate([("ab", "bc"), ("db", "ba"), ("cb", "bd"), ("ab", "bd")] * 3)
    )
    more.write_text(f"<routes>{trips}</routes>")
    play_alone(folder / "small.sumocfg", tmp_path, seed=3, step_s=STEP_S, until_s=60.0, latest_s=300.0, more=more)
    ours = read_trips(tmp_path).vehicles
    theirs = ET.parse(tmp_path / "sumo" / "statistics.xml").getroot()
    totals = theirs.find("vehicleTripStatistics")
    assert totals is not None
    count = int(totals.attrib["count"])
    assert count == len(ours) == 13
    assert sum(trip.length_m for trip in ours.values()) / count == pytest.approx(
        float(totals.attrib["routeLength"]), abs=0.01
    )
    assert sum(trip.loss_s for trip in ours.values()) / count == pytest.approx(
        float(totals.attrib["timeLoss"]), abs=0.01
    )
    assert sum(trip.duration_s for trip in ours.values()) == pytest.approx(
        float(totals.attrib["totalTravelTime"]), abs=0.1
    )
    assert all(trip.arrived and trip.co2_kg > 0.0 for trip in ours.values())


def test_emissions_are_those_of_sumo_s_emission_output(folder: Path, tmp_path: Path) -> None:
    config = tmp_path / "emissions.sumocfg"
    text = (folder / "small.sumocfg").read_text().replace('value="', f'value="{folder}/')
    out = tmp_path / "emissions.xml"
    config.write_text(text.replace("</input>", f'</input><output><emission-output value="{out}"/></output>'))
    play_alone(config, tmp_path, seed=3, step_s=STEP_S, until_s=60.0, latest_s=120.0)
    rows = ET.parse(out).getroot().iter("vehicle")
    per_s_kg = [float(row.attrib["CO2"]) / 1e6 for row in rows]
    ours_kg = sum(trip.co2_kg for trip in read_trips(tmp_path).vehicles.values())
    assert ours_kg == pytest.approx(sum(per_s_kg) * STEP_S, rel=0.03)  # the first and the last step count in one only
    assert ours_kg > 0.0


def test_a_slow_vehicle_that_was_driven_elsewhere_holds_up_the_one_behind(folder: Path, tmp_path: Path) -> None:
    from basu_sumo.link import in_process  # noqa: PLC0415 - one SUMO at a time

    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=3)
    x_m, y_m = link.api.simulation.convert2D("ab", 40.0, 0)
    offset_m = link.offset_m
    link.close()
    record = slow()._replace(x_m=slow().x_m - 30.0 + x_m - offset_m[0], y_m=np.full(3000, -(y_m - offset_m[1])))
    play(folder, tmp_path / "without")
    play(folder, tmp_path / "with", record)
    free, held = (read_trips(tmp_path / side).vehicles["one"] for side in ("without", "with"))
    assert held.length_m == pytest.approx(free.length_m)
    assert held.loss_s > free.loss_s + 60.0
    assert set(read_trips(tmp_path / "with").vehicles) == {"one"}


def test_two_plays_have_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    for name in ("first", "second"):
        play(folder, tmp_path / name, slow())
    first, second = ((tmp_path / name / "sumo" / "tripinfo.xml").read_bytes() for name in ("first", "second"))
    assert first == second


def test_a_trip_after_the_end_of_the_hours_is_left_out(folder: Path, tmp_path: Path) -> None:
    more = tmp_path / "more.rou.xml"
    more.write_text('<routes><trip id="late" type="traffic" depart="90" from="ab" to="bc"/></routes>')
    play_alone(folder / "small.sumocfg", tmp_path, seed=3, step_s=STEP_S, until_s=60.0, latest_s=200.0, more=more)
    assert set(read_trips(tmp_path).vehicles) == {"one"}
