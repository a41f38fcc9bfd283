"""Claims about trips that would begin or end in sight of a vehicle of the simulator."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from basu_sumo.frames import Pose
from basu_sumo.link import Link, in_process
from basu_sumo.mirrors import Mirrors
from basu_sumo.random_trips import RandomTrips
from basu_sumo.road_users import Look, RoadUser
from basu_sumo.trip_ends import SIGHT_M, Streets, TripEnds

pytest.importorskip("libsumo", reason="the extra for SUMO is not installed")
STEP_S = 0.05
CAR = Look("vehicle.audi.a2", 3.7, None, is_person=False)


def driven(link: Link, viewers_m: tuple[tuple[float, float], ...], steps: int = 1600) -> tuple[TripEnds, str | None]:
    """Let SUMO drive while ``viewers_m`` see it; where "one" was last, if it has gone."""
    ends, edge = TripEnds(link), None
    for _ in range(steps):
        link.step()
        if "one" not in link.api.vehicle.getIDList():
            if edge is not None:
                return ends, edge
            continue
        edge = link.api.vehicle.getRoadID("one")
        x_m, y_m = link.api.vehicle.getPosition("one")
        pose = Pose(x_m - link.offset_m[0], link.offset_m[1] - y_m, 0.0, 0.0, 0.0)
        ends.look({"one": RoadUser(CAR, pose, 0, 0.0)}, viewers_m)
    return ends, None


def test_the_network_ends_where_a_single_street_leads(folder: Path) -> None:
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=0)
    assert Streets(link).exits == {"ba", "bc", "bd"}
    assert Streets(link).entrances == {"ab", "cb", "db"}


def test_a_trip_that_ends_in_the_midst_of_the_streets_goes_on_while_it_is_seen(folder: Path) -> None:
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=0)
    link.api.route.add("short", ["ab"])
    link.api.vehicle.add("one", "short", typeID="vehicle.audi.a2")
    ends, edge = driven(link, ((200.0, 0.0), (0.0, 0.0), (400.0, 0.0), (200.0, -200.0)))
    assert ends.prolonged >= 1
    assert edge in {"ba", "bc", "bd", None}, "it drove on, and left at an end of the network if at all"
    link.close()


def test_a_trip_that_nothing_sees_ends_as_it_was_planned(folder: Path) -> None:
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=0)
    link.api.route.add("short", ["ab"])
    link.api.vehicle.add("one", "short", typeID="vehicle.audi.a2")
    ends, edge = driven(link, ((200.0, 10_000.0),))
    assert (ends.prolonged, edge) == (0, "ab")
    link.close()


def test_a_trip_to_the_end_of_the_network_ends_there_in_sight(folder: Path) -> None:
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    ends, edge = driven(link, ((400.0, 0.0),))
    assert (ends.prolonged, edge) == (0, "bc")
    link.close()


def test_random_trips_begin_out_of_sight(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("basu_sumo.random_trips.LEAST_EDGES", 2)
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=0)
    trips = RandomTrips(link, 3, 1, lambda: ((0.0, 0.0),))
    trips.fill()
    starts = {link.api.vehicle.getRoute(name)[0] for name in link.api.vehicle.getLoadedIDList()}
    assert starts
    assert "ab" not in starts, f"it begins within {SIGHT_M:g} m"
    none = RandomTrips(link, 3, 1, lambda: ((0.0, 0.0), (200.0, 0.0), (400.0, 0.0), (200.0, -200.0)))
    none._number = 100
    none.fill()
    assert none._alive == set(), "where all is seen, a trip begins later"
    link.close()


def test_drivers_behind_a_mirrored_vehicle_know_its_speed(folder: Path) -> None:
    """SUMO's own figure falls to 0 where the mirrored vehicle comes from one lane to another within a junction."""
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=0)
    actor = SimpleNamespace(
        id=7, type_id="vehicle.x", attributes={}, bounding_box=SimpleNamespace(extent=SimpleNamespace(x=2, y=1, z=1))
    )
    world = SimpleNamespace(get_actors=lambda _: [actor])
    mirrors = Mirrors(link, world, SimpleNamespace(base_types={}))  # type: ignore[arg-type]
    seen = []
    for tick in range(200):
        location = SimpleNamespace(x=150.0 + 0.5 * tick, y=1.6)
        pose = SimpleNamespace(location=location, rotation=SimpleNamespace(yaw=0.0))

        class Snapshot(list):  # type: ignore[type-arg]
            timestamp = SimpleNamespace(elapsed_seconds=tick * STEP_S)

            def find(self, _: int, pose: SimpleNamespace = pose) -> SimpleNamespace:
                return SimpleNamespace(get_transform=lambda: pose)

        mirrors.move(Snapshot([actor]), [])  # type: ignore[arg-type]
        if tick > 1:
            seen.append(link.api.vehicle.getSpeed("carla7"))
        link.step()
    assert seen == pytest.approx([10.0] * len(seen))
    assert mirrors.places_m == ((150.0 + 0.5 * 199, 1.6),)
    link.close()
