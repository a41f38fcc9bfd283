"""More rows of soak.py: those that load, spawn and destroy, and those that send what no client means."""

import contextlib
import random
import time

import carla
from soak_rows import Done, Target, caller, official, settle, subscriber

from fakes.client_programs import RELOADING, client_program
from fakes.raw_client import RawClient, request

OPENING = b"\x94\x00\x01\xa7version\x92\x91\xc2"  # a request, up to where its argument begins


def reloads(target: Target, count: int, done: Done) -> str:
    """Load again and again while a car drives and somebody listens, who reads all that comes."""
    with caller(target) as client, subscriber(target, 1) as listener:
        listener.socket.setblocking(False)
        points = client.call("get_map_info")[1]
        for number in range(count):
            client.call("load_new_episode", "", False, 0xFFFF)
            client.call("spawn_actor", [0, "vehicle.tesla.model3", []], points[number % len(points)])
            client.call("tick_cue")
            with contextlib.suppress(BlockingIOError):
                while listener.socket.recv(1 << 20):
                    pass
            done()
    return "each with a car and a tick"


def official_reloads(target: Target, count: int, done: Done) -> str:
    """The client drops its stream at every reload and, once in a thousand or so, ends itself over it."""
    made = ended = 0
    while made < count:
        with client_program(target.port, RELOADING) as client:
            while made < count and client.stdout.readline():
                made += 1
                done()
            ended += made < count
    return f"the client ended itself {ended} times"


def towns(target: Target, count: int, done: Done) -> str:
    client, _ = official(target)
    names = [name for name in client.get_available_maps() if not name.endswith("/Linden")]
    longest_s = {"cold": 0.0, "warm": 0.0}
    for turn in range(2 * count):
        for name in names:
            began_s = time.perf_counter()
            client.load_world(name, reset_settings=False)
            kind = "cold" if turn == 0 else "warm"
            longest_s[kind] = max(longest_s[kind], time.perf_counter() - began_s)
        done()
    return ", ".join(f"longest {kind} {longest:.2f} s" for kind, longest in longest_s.items())


def sensor_cycles(target: Target, count: int, done: Done) -> str:
    _, world = official(target)
    library = world.get_blueprint_library()
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), world.get_map().get_spawn_points()[0])
    world.tick()
    heard: list[int] = []
    for number in range(count):
        blueprint = library.find("sensor.other." + ("imu", "gnss", "collision")[number % 3])
        sensor = world.spawn_actor(blueprint, carla.Transform(), attach_to=car)
        sensor.listen(lambda event: heard.append(event.frame))
        for _ in range(3):
            world.tick()
        sensor.stop()
        sensor.destroy()
        done()
    return f"{len(heard)} events heard"


TEN_CAMERAS = (
    *("rgb", "depth", "semantic_segmentation", "instance_segmentation", "normals", "optical_flow", "dvs"),
    *("rgb", "depth", "semantic_segmentation"),
)
"""All kinds, and three of them twice, so that some look out of one place together."""
AT_ONCE = 9
"""How many of them show something in the first frame: one for events has nothing to compare it with."""


def camera_cycles(target: Target, count: int, done: Done) -> str:
    """Ten small cameras on a car, all at once: made, listened to, stopped and destroyed, again and again."""
    client, world = official(target)
    library = world.get_blueprint_library()
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), world.get_map().get_spawn_points()[0])
    world.tick()
    seen: list[int] = []
    for _ in range(count):
        cameras = [_camera(world, library, kind, car) for kind in TEN_CAMERAS]
        for camera in cameras:
            camera.listen(lambda picture: seen.append(len(picture)))
        expected, patient_until_s = len(seen) + AT_ONCE, time.monotonic() + 1.0
        world.tick()
        while len(seen) < expected and time.monotonic() < patient_until_s:
            time.sleep(0.001)
        for camera in cameras:
            camera.stop()
        for _ in range(3):
            world.tick()
        client.apply_batch_sync([carla.command.DestroyActor(camera) for camera in cameras], True)
        done()
    assert not world.get_actors().filter("sensor.*")
    return f"{len(seen)} pictures and event lists seen, of {len(TEN_CAMERAS) * count}"


def _camera(world: carla.World, library: carla.BlueprintLibrary, kind: str, car: carla.Actor) -> carla.Sensor:
    blueprint = library.find(f"sensor.camera.{kind}")
    blueprint.set_attribute("image_size_x", "32")
    blueprint.set_attribute("image_size_y", "24")
    return world.spawn_actor(blueprint, carla.Transform(carla.Location(x=1.5, z=1.6)), car)


def one_by_one(target: Target, count: int, done: Done) -> str:
    with caller(target) as client:
        points = client.call("get_map_info")[1]
        for number in range(count):
            point = points[number % len(points)]
            actor_id = client.call("spawn_actor", [0, "vehicle.tesla.model3", []], point)[0]
            client.call("destroy_actor", actor_id)
            if number % 10 == 0:
                client.call("tick_cue")
            done()
    return "a tick after every tenth"


def all_at_once(target: Target, count: int, done: Done) -> str:
    """Props in the air, where there is room for any number."""
    longest_s = [0.0, 0.0]
    with caller(target) as client:
        for begin in range(0, count, 10_000):
            many = min(10_000, count - begin)
            places = [[5.0 * (i % 100), 5.0 * (i // 100), 300.0] for i in range(many)]
            barrier = [0, "static.prop.streetbarrier", []]
            spawns = [[[0, [barrier, [place, [0.0, 0.0, 0.0]], [False], 0, "", []]]] for place in places]
            ids = []
            for turn in range(2):
                began_s = time.perf_counter()
                batch = spawns if turn == 0 else [[[1, [actor_id]]] for actor_id in ids]
                client.send("apply_batch", batch, False)
                answers = client.answer()[3]
                longest_s[turn] = max(longest_s[turn], time.perf_counter() - began_s)
                ids = [answer[0][1] for answer in answers if answer[0][0] == 1]
                client.call("tick_cue")
            for _ in range(many):
                done()
    return f"10,000 a batch: spawned in {longest_s[0]:.2f} s, destroyed in {longest_s[1]:.2f} s"


def large_batches(target: Target, count: int, done: Done) -> str:
    with caller(target) as client:
        actor = client.call("spawn_actor", [0, "vehicle.tesla.model3", []], client.call("get_map_info")[1][0])
        control = [[2, [actor[0], [0.1, 0.0, 0.0, False, False, False, 0]]]]
        longest_s = 0.0
        for _ in range(count):
            began_s = time.perf_counter()
            client.send("apply_batch", [control] * 20_000, True)
            assert len(client.answer()[3]) == 20_000
            longest_s = max(longest_s, time.perf_counter() - began_s)
            done()
    return f"20,000 controls each; longest {longest_s:.2f} s"


def bad_packets(target: Target, count: int, done: Done) -> str:
    chance = random.Random(20_261_121)
    whole = [request(1, "spawn_actor", [0, "vehicle.tesla.model3", []], [[0.0] * 3, [0.0] * 3]), request(1, "version")]
    kinds = {
        "noise": lambda: chance.randbytes(chance.randrange(1, 300)),
        "changed": lambda: _changed(chance, bytearray(chance.choice(whole))),
        "longest text": lambda: OPENING + b"\xdb\xff\xff\xff\xff",
        "longest array": lambda: OPENING + b"\xdd\xff\xff\xff\xff",
        "deepest": lambda: OPENING + b"\x91" * 100_000,
    }
    for number in range(count):
        port = target.streaming_port if number % 7 == 0 else target.port
        client = RawClient(port)
        try:
            client.socket.sendall(list(kinds.values())[number % len(kinds)]())
        except OSError:
            continue  # it was shown out before it had finished
        finally:
            client.reset()
            done()
    settle(target)
    return ", ".join(kinds)


def _changed(chance: random.Random, whole: bytearray) -> bytes:
    for _ in range(chance.randrange(1, 6)):
        whole[chance.randrange(len(whole))] = chance.randrange(256)
    return bytes(whole)
