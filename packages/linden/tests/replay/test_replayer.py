import math
from pathlib import Path

import numpy as np
import pytest

from fakes import recordings as made
from fakes.street_drive import HERO, STEP_S, Drive, spawned, street
from linden.geometry import compose
from linden.maps.library import LoadedMap
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.snapshot import TRAFFIC_LIGHT_ROW, VEHICLE_ROW
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.replay.file.packets import RecordingError
from linden.replay.file.read import Recording
from linden.replay.file.track import track_of
from linden.replay.replayer import ReplayPlan
from linden.simulation.doors import Door
from linden.world import World

FRAMES = 30
ALL = ReplayPlan(start_s=0.0, duration_s=0.0, follow_id=0, offset=Transform(), replay_sensors=False)


@pytest.fixture(scope="module")
def world_map() -> LoadedMap:
    return street()


@pytest.fixture
def recorded(world_map: LoadedMap, tmp_path: Path) -> "Recorded":
    return Recorded(world_map, tmp_path / "drive.log")


class Recorded:
    """A drive and its recording: lamps and the light change, a car comes, another goes."""

    def __init__(self, world_map: LoadedMap, path: Path) -> None:
        self.drive, self.path, self.map = Drive(world_map), path, world_map
        self.ids = (self.drive.hero.id, self.drive.other.id, self.drive.walker.id)
        self.shown: list[bytes] = []
        self.light: list[bytes] = []
        self.drive.step(5)
        self.drive.record(path)
        for n in range(FRAMES):
            self._change(n)
            self.drive.step(1)
            self.shown.append(told(self.drive.simulation, *self.ids))
            self.light.append(light(self.drive.simulation))
        self.drive.simulation.recorder.stop()

    def _change(self, n: int) -> None:
        simulation = self.drive.simulation
        if n == 10:
            self.drive.other.light_state = 5
            simulation.episode.traffic.set_colour(0, TrafficLightState.RED)
            self.third = spawned(simulation, HERO, self.drive.along(40.0, 0.0))
        if n == 20:
            simulation.episode.traffic.freeze_all(frozen=True)
            simulation.destroy(self.third.id)


def told(simulation: World, *actor_ids: int) -> bytes:
    """What a snapshot tells of actors: where they are, and of vehicles all their controls; and their lamps."""
    actors = simulation.episode.actors
    parts = []
    for actor_id in actor_ids:
        row = actors.rows.view(VEHICLE_ROW)[actors.row(actor_id)]
        parts += [row["location"].tobytes(), row["rotation"].tobytes(), row["velocity"].tobytes()]
        if actors.get(actor_id).description.id.startswith("vehicle."):
            parts += [row[name].tobytes() for name in ("throttle", "steer", "brake", "hand_brake", "reverse", "gear")]
        parts.append(bytes([actors.get(actor_id).light_state]))
    return b"".join(parts)


def light(simulation: World) -> bytes:
    actors = simulation.episode.actors
    row = actors.rows.view(TRAFFIC_LIGHT_ROW)[actors.row(simulation.episode.light_ids[0])]
    return b"".join(row[name].tobytes() for name in ("frozen", "state", "elapsed_time"))


def start(simulation: World, path: Path, plan: ReplayPlan = ALL) -> None:
    simulation.replayer.start(simulation, track_of(Recording(path)), plan)


def fresh(recorded: Recorded, plan: ReplayPlan = ALL) -> World:
    simulation = World(recorded.map)
    start(simulation, recorded.path, plan)
    return simulation


def x_of(simulation: World, actor_id: int) -> float:
    return simulation.episode.transform(actor_id).location.x


def test_our_own_recording_is_replayed_to_the_last_bit(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    for n in range(FRAMES):
        simulation.step(STEP_S)
        assert told(simulation, *recorded.ids) == recorded.shown[n], f"frame {n}"
        assert light(simulation) == recorded.light[n], f"frame {n}"


def test_wheels_and_doors_stand_as_recorded(world_map: LoadedMap, tmp_path: Path) -> None:
    drive = Drive(world_map)
    bodies = drive.simulation.episode.bodies
    hero = spawned(drive.simulation, "vehicle.lincoln.mkz_2020", drive.along(40.0, 0.0))  # its doors move
    drive.record(tmp_path / "drive.log")
    shown = []
    for n in range(10):
        if n in (3, 6):
            drive.simulation.episode.doors.swing(hero, Door.REAR_LEFT, opens=n == 3)
        drive.simulation.episode.bodies.steer[hero.slot] = 0.1 * n
        drive.step(1)
        angles = [(bodies.wheel_steer_deg(hero.slot, k), bodies.wheel_pitch_deg(hero.slot, k)) for k in range(4)]
        shown.append((angles, drive.simulation.episode.doors.open.get(hero.id)))
    drive.simulation.recorder.stop()
    assert max(abs(steer_deg) for steer_deg, _ in shown[-2][0]) > 1.0
    simulation = World(world_map)
    start(simulation, tmp_path / "drive.log")
    for angles, doors in shown[:-1]:  # with the last the replay ends, and physics has the wheels again
        simulation.step(STEP_S)
        replayed, slot = simulation.episode.bodies, simulation.episode.actors.get(hero.id).slot
        found = [(replayed.wheel_steer_deg(slot, k), replayed.wheel_pitch_deg(slot, k)) for k in range(4)]
        np.testing.assert_allclose(found, angles, atol=1e-4)  # degrees, held as 32-bit floats
        assert simulation.episode.doors.open.get(hero.id) == doors


def test_actors_come_under_the_same_id_and_leave_as_recorded(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    there = []
    for _ in range(FRAMES):
        simulation.step(STEP_S)
        there.append(recorded.third.id in simulation.episode.actors)
    assert there == [False] * 10 + [True] * 10 + [False] * 10


def test_actors_of_the_same_id_and_type_are_reused(recorded: Recorded) -> None:
    simulation = recorded.drive.simulation
    before = len(simulation.episode.actors)
    start(simulation, recorded.path)
    simulation.step(STEP_S)
    assert len(simulation.episode.actors) == before
    assert told(simulation, *recorded.ids) == recorded.shown[0]


def test_the_id_of_another_actor_is_not_taken(recorded: Recorded) -> None:
    simulation = World(recorded.map)
    poses = [recorded.drive.along(-10.0 * n, 0.0) for n in range(3)]
    tenants = [spawned(simulation, "vehicle.mini.cooper_s", pose) for pose in poses]
    assert tenants[0].id == recorded.drive.hero.id
    where = [simulation.episode.transform(tenant.id).location[:2] for tenant in tenants]
    start(simulation, recorded.path)
    simulation.step(STEP_S)
    heroes = [record.id for record in simulation.episode.actors if record.description.id == HERO]
    assert len(heroes) == 1
    assert heroes[0] not in [tenant.id for tenant in tenants]
    for tenant, at in zip(tenants, where, strict=True):
        np.testing.assert_allclose(simulation.episode.transform(tenant.id).location[:2], at, atol=0.01)


def test_a_longer_step_skips_frames_and_a_shorter_one_goes_between_them(recorded: Recorded) -> None:
    double, half = fresh(recorded), fresh(recorded)
    hero = recorded.drive.hero.id
    for n in range(10):
        double.step(2.0 * STEP_S)
        assert told(double, *recorded.ids) == recorded.shown[2 * n]
    seen = []
    for _ in range(21):
        half.step(0.5 * STEP_S)
        seen.append(half.episode.transform(hero))
    for n in range(1, 20, 2):
        before, now, after = seen[n - 1 : n + 2]
        np.testing.assert_allclose(now.location, np.mean([before.location, after.location], axis=0), atol=1e-6)


def test_the_time_factor_is_as_good_as_another_step(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    simulation.replayer.time_factor = 3.0
    for n in range(9):
        simulation.step(STEP_S)
        assert told(simulation, *recorded.ids) == recorded.shown[3 * n]
    simulation.replayer.time_factor = 0.0
    for _ in range(3):
        simulation.step(STEP_S)
        assert told(simulation, *recorded.ids) == recorded.shown[24]


def test_angles_go_the_shorter_way_round(world_map: LoadedMap, tmp_path: Path) -> None:
    car = made.actor(50, HERO, 1, (0, 0, 100), (0, 0, 179))
    path = made.write(
        tmp_path,
        made.header(),
        made.frame(1, 0.0, made.added(car), made.positions((50, 0, 0, 100, 0, 0, 179))),
        made.frame(2, 0.1, made.positions((50, 100, 0, 100, 0, 0, -175)), duration_s=-1.0),
    )
    simulation = World(world_map)
    start(simulation, path)
    simulation.step(STEP_S)
    simulation.step(STEP_S)
    at = simulation.episode.transform(50)
    assert at.location == pytest.approx((0.5, 0.0, 1.0))
    assert math.remainder(at.rotation.yaw - 182.0, 360.0) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("start_s", "duration_s", "first", "frames"),
    [(0.5, 0.0, 10, 20), (-0.5, 0.0, 19, 11), (0.5, 0.25, 10, 6), (-99.0, 0.0, 0, 30), (99.0, 0.0, 29, 1)],
)
def test_a_part_can_be_replayed(recorded: Recorded, start_s: float, duration_s: float, first: int, frames: int) -> None:
    simulation = fresh(recorded, ALL._replace(start_s=start_s, duration_s=duration_s))
    for n in range(frames):
        simulation.step(STEP_S)
        assert told(simulation, *recorded.ids) == recorded.shown[first + n]
    speed = [np.linalg.norm(simulation.episode.bodies.velocity[slot]) for slot in (0, 1)]
    assert speed == [0.0, 0.0]  # it is over: they have been stopped


def test_at_the_end_everybody_stands_still_and_the_physics_has_them_again(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    for _ in range(FRAMES + 1):
        simulation.step(STEP_S)
    bodies, actors = simulation.episode.bodies, simulation.episode.actors
    hero = actors.get(recorded.drive.hero.id)
    assert bodies.simulate[hero.slot]
    assert bodies.collides[hero.slot]
    assert (bodies.control(hero.slot).throttle, bodies.throttle[hero.slot]) == (0.0, 0.0)
    assert told(simulation, *recorded.ids) != recorded.shown[-1]
    at = simulation.episode.transform(hero.id).location
    for _ in range(20):
        simulation.step(STEP_S)
    np.testing.assert_allclose(simulation.episode.transform(hero.id).location, at, atol=0.1)


def test_while_they_are_replayed_no_actor_runs_into_them(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    simulation.step(STEP_S)
    hero = recorded.drive.hero.id
    at = simulation.episode.transform(hero)
    guest = simulation.spawn(recorded.drive.hero.description, Transform(Vector3D(0.0, 0.0, 1000.0)))
    simulation.episode.place(guest.id, at)
    simulation.step(STEP_S)
    assert not len(simulation.episode.contacts)


def test_the_hero_is_left_out_where_asked_for(recorded: Recorded) -> None:
    simulation = World(recorded.map)
    own = spawned(simulation, HERO, recorded.drive.along(-20.0, 0.0), role="hero")
    assert own.id == recorded.drive.hero.id
    simulation.replayer.ignore_hero = True
    start(simulation, recorded.path)
    simulation.step(STEP_S)
    assert [r.id for r in simulation.episode.actors if r.description.id == HERO] == [own.id]
    assert simulation.episode.bodies.simulate[own.slot]
    assert abs(x_of(simulation, own.id) - recorded.drive.along(-20.0, 0.0).location.x) < 0.1


def test_the_spectator_moves_only_where_asked_for(recorded: Recorded, tmp_path: Path) -> None:
    path = made.write(
        tmp_path,
        made.header(),
        made.frame(
            1,
            0.0,
            made.added(made.actor(1, "spectator", 0)),
            made.positions((1, 500, 600, 700, 1, 2, 3)),
            duration_s=-1.0,
        ),
        name="spectator.log",
    )
    for ignored, expected in (
        (True, Transform()),
        (False, Transform(Vector3D(5.0, 6.0, 7.0), Rotation(2.0, 3.0, 1.0))),
    ):
        simulation = World(recorded.map)
        simulation.replayer.ignore_spectator = ignored
        start(simulation, path)
        simulation.step(STEP_S)
        assert simulation.episode.transform(simulation.episode.spectator_id) == expected


def test_the_spectator_follows_the_chosen_actor(recorded: Recorded) -> None:
    offset = Transform(Vector3D(-10.0, 0.0, 5.0), Rotation(-25.0, 0.0, 0.0))
    hero = recorded.drive.hero.id
    simulation = fresh(recorded, ALL._replace(follow_id=hero, offset=offset))
    for _ in range(3):
        simulation.step(STEP_S)
    episode = simulation.episode
    assert episode.transform(episode.spectator_id) == compose(episode.transform(hero), offset)


def test_sensors_are_attached_again_where_asked_for(recorded: Recorded) -> None:
    simulation = fresh(recorded, ALL._replace(replay_sensors=True))
    imu = simulation.episode.actors.get(recorded.drive.imu.id)
    assert (imu.description.id, imu.parent_id) == ("sensor.other.imu", recorded.drive.hero.id)
    assert simulation.episode.own_transform(imu.id) == Transform(Vector3D(1.0, 0.0, 2.0))
    assert recorded.drive.imu.id not in fresh(recorded).episode.actors


def test_stopping_leaves_all_actors_or_destroys_the_replayed_ones(recorded: Recorded) -> None:
    for keep_actors in (True, False):
        simulation = fresh(recorded)
        for _ in range(15):
            simulation.step(STEP_S)
        simulation.replayer.stop(keep_actors=keep_actors)
        actors = simulation.episode.actors
        assert (recorded.third.id in actors) is keep_actors
        assert recorded.drive.hero.id in actors
        assert simulation.episode.bodies.simulate[actors.get(recorded.drive.hero.id).slot]


def test_an_actor_that_a_client_destroys_meanwhile_is_not_missed(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    for n in range(FRAMES):
        if n == 5:
            simulation.destroy(recorded.drive.other.id)
        simulation.step(STEP_S)
    assert recorded.drive.other.id not in simulation.episode.actors


def test_what_the_library_lacks_is_left_out_and_told_once(
    world_map: LoadedMap, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    cast = made.added(
        made.actor(50, "vehicle.hover.board", 1),
        made.actor(51, "vehicle.hover.board", 1),
        made.actor(52, HERO, 1, attributes=[(3, "role_name", "hero"), (4, "color", "no colour"), (0, "wings", "2")]),
        made.actor(53, "traffic.traffic_light", 3, (9e6, 9e6, 0)),
    )
    path = made.write(tmp_path, made.header(), made.frame(1, 0.0, cast, duration_s=-1.0))
    simulation = World(world_map)
    start(simulation, path)
    assert sum("vehicle.hover.board is left out" in line for line in caplog.messages) == 1
    assert "is spawned with its own color" in caplog.text
    assert "the map has no traffic.traffic_light at (90000.00, 90000.00, 0.00)" in caplog.text
    hero = simulation.episode.actors.get(52)
    assert hero.description.attribute("role_name") == "hero"  # its type was numbered from 0, as in 2021
    assert hero.description.attribute("wings", "none") == "none"
    assert 50 not in simulation.episode.actors


def test_a_recording_without_a_frame_is_refused(world_map: LoadedMap, tmp_path: Path) -> None:
    simulation = World(world_map)
    with pytest.raises(RecordingError, match="holds no whole frame"):
        start(simulation, made.write(tmp_path, made.header()))
    simulation.step(STEP_S)


def test_a_recording_that_turns_out_damaged_ends_the_replay_and_nothing_else(
    recorded: Recorded, caplog: pytest.LogCaptureFixture
) -> None:
    with Recording(recorded.path) as recording:
        place = list(recording.places())[12]
    content = bytearray(recorded.path.read_bytes())
    count_of_added = place.start + 29 + 13 + 5  # behind the frame's start, the visual time and the packet's head
    content[count_of_added : count_of_added + 2] = b"\xff\xff"
    recorded.path.write_bytes(content)
    simulation = fresh(recorded)
    for _ in range(FRAMES):
        simulation.step(STEP_S)
    assert "the replay ends here" in caplog.text
    assert simulation.episode.bodies.simulate[simulation.episode.actors.get(recorded.drive.hero.id).slot]


def test_a_load_of_a_map_ends_the_replay(recorded: Recorded) -> None:
    simulation = fresh(recorded)
    simulation.step(STEP_S)
    simulation.load(recorded.map, reset_settings=False)
    simulation.step(STEP_S)
    assert recorded.drive.hero.id not in simulation.episode.actors


def test_no_number_of_a_file_reaches_the_physics_unheld(world_map: LoadedMap, tmp_path: Path) -> None:
    nan, vast = float("nan"), 1e38
    cast = made.added(
        made.actor(50, HERO, 1, (nan, vast, -vast), (nan, vast, 0)),
        made.actor(51, "walker.pedestrian.0001", 2),
        made.actor(52, HERO, 1, (nan, 0, 0)),  # attached: it has no body of its own
        made.actor(53, "static.prop.barrel", 0, (vast, nan, 0)),
    )
    wild = (
        made.several(4, "II", [(52, 50)]),
        made.positions((50, nan, vast, 0, nan, vast, 0), (51, vast, vast, vast, 0, 0, vast), (52, *[nan] * 6)),
        made.several(8, "IfffBi", [(i, nan, vast, -vast, 9, 99) for i in (50, 52)]),
        made.several(9, "If", [(51, nan)]),
        made.several(12, "I6f", [(50, *[vast] * 6), (51, *[nan] * 6), (52, *[vast] * 6)]),
    )
    path = made.write(
        tmp_path,
        made.header(),
        made.frame(1, 0.0, cast, *wild, duration_s=0.1),
        made.frame(2, 0.1, *wild[1:], duration_s=-1.0),
    )
    simulation = World(world_map)
    start(simulation, path)
    for _ in range(6):
        simulation.step(STEP_S)
        bodies = simulation.episode.bodies
        for column in (bodies.position, bodies.rotation, bodies.velocity, bodies.throttle, bodies.walker_speed):
            assert np.isfinite(column).all()
        for field in ("location", "rotation", "velocity"):
            assert np.isfinite(simulation.episode.actors.rows[field]).all()
    assert bodies.gear.max() <= bodies.table.specs["gear_count"].max()


@pytest.mark.parametrize("elapsed_s", [float("nan"), -1.0])
def test_times_that_do_not_go_forward_are_refused(world_map: LoadedMap, tmp_path: Path, elapsed_s: float) -> None:
    path = made.write(tmp_path, made.header(), made.frame(1, 0.0), made.frame(2, elapsed_s))
    with pytest.raises(RecordingError, match="do not go forward"):
        start(World(world_map), path)
