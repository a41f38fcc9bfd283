"""Rows of sensors.py measured through the official client: from a tick until all that was seen is in its hands."""

import queue
import statistics
import time
from collections.abc import Iterator

import carla
from live import LINDEN, Live, cpu_s, server
from sensor_rows import CAR, OTHERS, THROTTLE, Figures, Row, Sensor

WARM_UP = 3
TIMEOUT_S = 120.0
PARTING_TICKS = 3
"""After a sensor's stop, before it is destroyed: what is on the way arrives."""


def measured(device: str, rows: tuple[Row, ...], vehicles: int, frame_count: int) -> Iterator[tuple[Row, Figures]]:
    """Measure each row in a server of its own making: medians over the frames."""
    with server([*LINDEN, "--device", device]) as live:
        client = carla.Client("127.0.0.1", live.port)
        client.set_timeout(TIMEOUT_S)
        world = client.get_world()
        for row in rows:
            settings = world.get_settings()
            settings.synchronous_mode, settings.fixed_delta_seconds = True, row.step_s
            world.apply_settings(settings)
            ids = populate(client, world, vehicles)
            yield row, ridden(live, world, world.get_actor(ids[0]), row, frame_count)
            client.apply_batch_sync([carla.command.DestroyActor(actor_id) for actor_id in ids], True)


def populate(client: carla.Client, world: carla.World, vehicles: int) -> list[int]:
    """Spawn a car, and others around it, all on their way; returns their ids, the car's first."""
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    places = [(CAR, points[0])]
    places += [(OTHERS[number % len(OTHERS)], points[3 * number + 3]) for number in range(vehicles)]
    go = carla.VehicleControl(throttle=THROTTLE)
    commands = [
        carla.command.SpawnActor(library.find(model), point).then(
            carla.command.ApplyVehicleControl(carla.command.FutureActor, go)
        )
        for model, point in places
    ]
    answers = client.apply_batch_sync(commands, True)
    refused = [answer.error for answer in answers if answer.has_error()]
    if refused:
        raise SystemExit(f"{len(refused)} of {len(places)} vehicles were refused: {refused[0]}")
    return [answer.actor_id for answer in answers]


def ridden(live: Live, world: carla.World, car: carla.Actor, row: Row, frame_count: int) -> Figures:
    """Let the car carry the row's sensors for some frames."""
    arrived: queue.Queue[tuple[int, int]] = queue.Queue()
    sensors = [listening(world, car, sensor, arrived) for sensor in row.sensors]
    taken_ms, sent, used_s = [], 0, 0.0
    for number in range(-WARM_UP, frame_count):
        if number == 0:
            used_s = cpu_s(live.process)
        begin_s = time.perf_counter()
        sent = whole_frame(world, arrived, len(sensors), is_first=number == -WARM_UP)
        taken_ms.append(1000.0 * (time.perf_counter() - begin_s))
    used_ms = 1000.0 * (cpu_s(live.process) - used_s) / frame_count
    for sensor in sensors:
        sensor.stop()
    for _ in range(PARTING_TICKS):
        world.tick(TIMEOUT_S)
    for sensor in sensors:
        sensor.destroy()
    return Figures(statistics.median(taken_ms[WARM_UP:]), used_ms, sent / 2**20)


def listening(
    world: carla.World, car: carla.Actor, sensor: Sensor, arrived: "queue.Queue[tuple[int, int]]"
) -> carla.Sensor:
    """Attach a sensor that tells of each measurement its frame and its bytes."""
    blueprint = world.get_blueprint_library().find(sensor.blueprint)
    for name, value in sensor.chosen.items():
        blueprint.set_attribute(name, value)
    place = carla.Transform(carla.Location(x=sensor.x_m, z=sensor.z_m), carla.Rotation(yaw=sensor.yaw_deg))
    actor = world.spawn_actor(blueprint, place, attach_to=car)
    actor.listen(lambda data: arrived.put((data.frame, len(getattr(data, "raw_data", b"")))))
    return actor


def whole_frame(world: carla.World, arrived: "queue.Queue[tuple[int, int]]", sensors: int, *, is_first: bool) -> int:
    """Tick and wait for every sensor; returns the bytes. The first time, tick until all listen."""
    frame = world.tick(TIMEOUT_S)
    found: dict[int, list[int]] = {}
    while len(found.get(frame, ())) < sensors:
        try:
            number, size = arrived.get(timeout=1.0 if is_first else TIMEOUT_S)
            found.setdefault(number, []).append(size)
        except queue.Empty:  # noqa: PERF203 - once, before the sensors are heard
            if not is_first:
                raise SystemExit(f"frame {frame}: {len(found.get(frame, ()))} of {sensors} sensors told") from None
            frame = world.tick(TIMEOUT_S)
    return sum(found[frame])
