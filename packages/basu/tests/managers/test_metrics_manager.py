"""Claims about the record as it grows: what each frame tells, and what is known while the run lasts."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.managers.base_manager import Ego, Frame, WorldChanges
from basu.managers.metrics_manager import MetricsManager
from basu.managers.observations import NO_LANE, LaneFinder
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring
from basu.records.history.model import NO_LIGHT
from basu.routing.planned_route import Progress, advance
from fakes.crossing_map import LANE_M, crossing
from fakes.drives import STEP_S, straight_route

FIRST_FRAME = 4000


class Sensor:
    """Keeps the callback."""

    id = 7

    def listen(self, hear: Any) -> None:
        self.hear = hear

    def stop(self) -> None:
        self.hear = None

    def destroy(self) -> None: ...


class Snapshot:
    """A world without others."""

    timestamp = SimpleNamespace(elapsed_seconds=0.0)

    def __len__(self) -> int:
        return 0


class Stage:
    """A run in the town of the crossing, eastwards, without a simulator."""

    def __init__(self) -> None:
        self.sensors: dict[str, Sensor] = {}
        asked = carla.VehicleControl(throttle=0.25)
        self.agents = SimpleNamespace(requested=asked, control=asked, manual=False)
        self.routes = SimpleNamespace(progress=Progress.at_start(), lane=NO_LANE)
        self.lanes = LaneFinder(carla.Map("Crossing", crossing()))
        self.route = straight_route(60.0, limit_mps=10.0)
        self.route.points_m[:, 1] = LANE_M / 2.0
        self.metrics = MetricsManager(self.agents, self.routes, Scoring())
        world = SimpleNamespace(
            get_blueprint_library=lambda: SimpleNamespace(find=lambda name: name),
            spawn_actor=lambda name, *_, **__: self.sensors.setdefault(name, Sensor()),
            get_actors=list,
        )
        vehicle = SimpleNamespace(
            id=1,
            type_id="vehicle.easymile.ez10",
            bounding_box=carla.BoundingBox(carla.Location(0.5, 0.0, 1.0), carla.Vector3D(2.0, 1.0, 1.0)),
            is_at_traffic_light=lambda: False,
            get_speed_limit=lambda: 36.0,
        )
        self.metrics.setup(
            SimpleNamespace(
                world=world,
                vehicle=vehicle,
                route=self.route,
                step_s=STEP_S,
                carla_map=carla.Map("Crossing", crossing()),
                neighbours=None,
                changes=WorldChanges(),
            )
        )
        self.tick = 0

    def drive(self, ticks: int, speed_mps: float) -> None:
        """Go on for some frames."""
        for _ in range(ticks):
            x_m = self.tick * speed_mps * STEP_S
            self.routes.progress = advance(self.route, self.routes.progress, x_m, LANE_M / 2.0)
            ego = Ego(x_m, LANE_M / 2.0, 0.0, 0.0, 0.0, 0.0, speed_mps, *[0.0] * 8)
            self.routes.lane = self.lanes.under(ego)
            self.metrics.tick(Frame(self.tick, FIRST_FRAME + self.tick, Snapshot(), ego))
            self.tick += 1

    def hit(self, tick: int) -> None:
        """The collision sensor speaks."""
        event = SimpleNamespace(
            frame=FIRST_FRAME + tick,
            other_actor=SimpleNamespace(id=0, type_id="static.poles"),
            normal_impulse=carla.Vector3D(100.0, 0.0, 0.0),
        )
        self.sensors["sensor.other.collision"].hear(event)


def test_a_frame_tells_the_lane_one_that_drives_and_the_light_ahead() -> None:
    stage = Stage()
    stage.drive(1, 8.0)
    stage.agents.manual = True
    stage.drive(1, 8.0)
    first, second = stage.metrics.history().frames
    assert first["off_lane_m"] == 0.0
    assert first["in_junction"] == 1  # the route begins in the middle of the crossing
    assert math.isfinite(first["lane_heading_rad"])
    assert first["route_light"] == first["traffic_light_state"] == NO_LIGHT
    assert first["speed_limit_mps"] == pytest.approx(10.0)
    assert (first["manual"], second["manual"]) == (0, 1)


def test_what_is_known_while_the_run_lasts_is_what_the_record_tells_then() -> None:
    stage = Stage()
    for second in range(4):
        stage.drive(20, 13.0)
        if second == 1:
            stage.hit(30)
        history = stage.metrics.history()
        assert stage.metrics.infractions_so_far() == infractions(history)
        assert stage.metrics.scores_so_far() == pytest.approx(score(history, Scoring()))
    kinds = [found.kind.value for found in stage.metrics.infractions_so_far()]
    assert kinds == ["speeding", "collision_static"]


def test_asking_twice_in_a_frame_gives_the_same_answer() -> None:
    stage = Stage()
    stage.drive(30, 13.0)
    assert stage.metrics.infractions_so_far() == stage.metrics.infractions_so_far()


def test_the_latest_contacts_are_known_by_tick() -> None:
    stage = Stage()
    stage.drive(40, 5.0)
    for tick in (5, 30, 35, 90):
        stage.hit(tick)
    assert [event.tick for event in stage.metrics.contacts_since(20)] == [30, 35]


@pytest.mark.parametrize("looked_at", [False, True])
def test_the_requested_and_the_applied_control_are_recorded(*, looked_at: bool) -> None:
    """A person's or a scenario's control is not the agent's; it may be known only after the frame was read."""
    stage = Stage()
    stage.agents.control = carla.VehicleControl(throttle=0.5, steer=-0.25)
    stage.drive(2, 8.0)
    if looked_at:
        stage.metrics.infractions_so_far()
    stage.metrics.applied(carla.VehicleControl(brake=1.0, hand_brake=True))
    stage.drive(1, 8.0)
    frames = stage.metrics.history().frames
    assert frames["throttle"].tolist() == [0.25, 0.25, 0.25]
    assert frames["applied_throttle"].tolist() == [0.5, 0.0, 0.5]
    assert frames["applied_steer"].tolist() == [-0.25, 0.0, -0.25]
    assert (frames["applied_brake"].tolist(), frames["applied_hand_brake"].tolist()) == ([0.0, 1.0, 0.0], [0, 1, 0])
