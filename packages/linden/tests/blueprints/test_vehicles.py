"""Every vehicle of the library driven by the physics: it sets off, holds its line, stops, and stays."""

import numpy as np
import pytest

from linden.blueprints.library import BlueprintLibrary
from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.step import advance
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Transform, Vector3D

LIBRARY = BlueprintLibrary.load()
SLOWEST_MPS = {"bicycle": 2.0, "bus": 3.0}
"""Speed after three seconds at full throttle that the slowest of a base type still reaches; 5 m/s for the others."""


class Fleet:
    """One of each vehicle, side by side, 40 m apart, all heading along x."""

    def __init__(self) -> None:
        self.bodies = Bodies()
        self.slots: dict[str, int] = {}
        for lane, blueprint in enumerate(found for found in LIBRARY if found.vehicle is not None):
            assert blueprint.vehicle is not None
            pose = Transform(Vector3D(0.0, 40.0 * lane, 0.0))
            physics, offsets, undercarriage = blueprint.vehicle
            slot = self.bodies.add_vehicle(physics, pose, blueprint.box, offsets, undercarriage)
            self.slots[blueprint.definition.id] = slot

    def drive(self, seconds: float, control: VehicleControl) -> None:
        for slot in self.slots.values():
            self.bodies.set_control(slot, control)
        for _ in range(round(20 * seconds)):
            advance(self.bodies, Ground.flat(0.0), Statics.none(), 0.05, 5)

    def speeds_mps(self) -> dict[str, float]:
        return {name: float(np.linalg.norm(self.bodies.velocity[slot])) for name, slot in self.slots.items()}

    def gears(self) -> dict[str, int]:
        return {name: int(self.bodies.gear[slot]) for name, slot in self.slots.items()}


def base_type(name: str) -> str:
    return next(a.value for a in LIBRARY.find(name).definition.attributes if a.id == "base_type")


@pytest.fixture(scope="module")
def drive() -> dict[str, dict[str, float]]:
    """Speeds of one drive by what had been done before."""
    fleet = Fleet()
    seen = {}
    fleet.drive(3.0, VehicleControl(throttle=1.0))
    seen["after three seconds"] = fleet.speeds_mps()
    fleet.drive(42.0, VehicleControl(throttle=1.0))
    seen["in the end"] = fleet.speeds_mps()
    seen["off its line, m"] = {name: abs(float(fleet.bodies.position[s, 1]) % 40.0) for name, s in fleet.slots.items()}
    fleet.drive(25.0, VehicleControl(brake=1.0))
    seen["braked"] = fleet.speeds_mps()
    return seen


def test_everything_sets_off(drive: dict[str, dict[str, float]]) -> None:
    for name, speed_mps in drive["after three seconds"].items():
        assert speed_mps > SLOWEST_MPS.get(base_type(name), 5.0), name


def test_everything_goes_straight_on(drive: dict[str, dict[str, float]]) -> None:
    for name, off_m in drive["off its line, m"].items():
        assert min(off_m, 40.0 - off_m) < 0.05, name  # after two kilometres and more


def test_everything_stops_and_stays(drive: dict[str, dict[str, float]]) -> None:
    assert set(drive["braked"].values()) == {0.0}


def test_the_shuttle_tops_out_at_forty_kilometres_an_hour(drive: dict[str, dict[str, float]]) -> None:
    assert 3.6 * drive["in the end"]["vehicle.easymile.ez10"] == pytest.approx(40.0, abs=0.3)


def test_bicycles_do_not_exceed_thirty(drive: dict[str, dict[str, float]]) -> None:
    bicycles = [speed for name, speed in drive["in the end"].items() if base_type(name) == "bicycle"]
    assert len(bicycles) == 3
    assert all(18.0 < 3.6 * speed_mps < 30.0 for speed_mps in bicycles)


def test_a_bicycle_rolls_as_long_as_the_literature_says() -> None:
    """Against dv/dt = -(0.5 rho CdA v^2 / m + g Crr), from 10 m/s.

    CdA 0.4 to 0.7 m2 (racing to upright), Crr 0.004 to 0.008 (road to city tyres): Wilson, Bicycling Science, 3rd ed.,
    tables 5.1 and 6.1.
    """
    fleet = Fleet()
    fleet.drive(1.0, VehicleControl(gear=1))
    for name, slot in fleet.slots.items():
        if base_type(name) == "bicycle":
            fleet.bodies.set_target_velocity(slot, Vector3D(10.0, 0.0, 0.0))
    fleet.drive(5.0, VehicleControl(gear=1))
    for name, speed_mps in fleet.speeds_mps().items():
        if base_type(name) == "bicycle":
            assert coasted_mps(0.7, 0.008) - 0.3 < speed_mps < coasted_mps(0.4, 0.004) + 0.3, name


def coasted_mps(cda_m2: float, crr: float) -> float:
    """The speed after 5 s of coasting from 10 m/s with 80 kg, by small steps."""
    speed_mps = 10.0
    for _ in range(5000):
        speed_mps -= 0.001 * (0.5 * 1.2 * cda_m2 * speed_mps**2 / 80.0 + 9.81 * crr)
    return speed_mps


def test_no_gearbox_hunts_at_a_steady_throttle() -> None:
    fleet = Fleet()
    changes = dict.fromkeys(fleet.slots, 0)
    for throttle in (0.4, 0.7):
        fleet.drive(20.0, VehicleControl(throttle=throttle))
        before = fleet.gears()
        for _ in range(200):
            fleet.drive(0.05, VehicleControl(throttle=throttle))
            now = fleet.gears()
            for name in changes:
                changes[name] += now[name] != before[name]
            before = now
    assert {name: count for name, count in changes.items() if count > 6} == {}  # in 20 s
