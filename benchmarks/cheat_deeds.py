"""Drivers that cheat by what their client and their process do; ``benchmarks/cheats.py`` drives them.

Each drives as ``behavioral`` and tries its deed in its tenth step, or in each step from there on. If the deed is
refused, it prints why and drives on.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import random
import resource
import signal
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import carla

sys.path.insert(0, str(Path(__file__).parent))
from cheat_drivers import Honest, Polyline

if TYPE_CHECKING:
    from collections.abc import Mapping

BEGIN_STEP = 10
HIDDEN_STEP = 30
SCANNED_PORTS = range(1024, 65536)
TRAFFIC_PORTS = range(28000, 29000)
MPTCP = 262  # IPPROTO_MPTCP
OUTPUT = Path(os.environ.get("CHEATS_OUTPUT", "runs"))
"""The folder of results, which an agent would find by a search."""


class Deed(Honest):
    """Tries :meth:`deed` in one step, or in each one from there on."""

    again = False

    def setup(self) -> None:
        super().setup()
        self.steps = 0

    def deed(self) -> Any:  # noqa: ANN401 - whatever came of it
        raise NotImplementedError

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        self.steps += 1
        if self.steps == BEGIN_STEP or (self.again and self.steps > BEGIN_STEP):
            try:
                came = self.deed()
            except (RuntimeError, OSError, AttributeError) as error:
                came = f"{type(error).__name__}: {error}"
            if self.steps == BEGIN_STEP:
                print(f"deed of {type(self).__name__}: {came}", flush=True)
        return super().run_step(sensor_data)

    def actors_around(self) -> list[Any]:
        """Return the other actors that move."""
        moving = [*self.world.get_actors().filter("vehicle.*"), *self.world.get_actors().filter("walker.*")]
        return [actor for actor in moving if actor.id != self.vehicle.id]

    @property
    def ahead(self) -> carla.Transform:
        """The place 60 m on."""
        assert self.route is not None
        return self.route.waypoints[min(60, len(self.route.waypoints) - 1)].transform


# -- named in issue 24: what the gate is for


class Teleports(Deed):
    """Sets itself at a place far ahead."""

    def deed(self) -> None:
        self.vehicle.set_transform(self.ahead)


class Pushes(Deed):
    """Pushes its vehicle with impulses."""

    again = True

    def deed(self) -> None:
        self.vehicle.add_impulse(carla.Vector3D(20000.0, 0.0, 0.0))


class ConstantVelocity(Deed):
    """Gives its vehicle a constant velocity."""

    def deed(self) -> None:
        self.vehicle.enable_constant_velocity(carla.Vector3D(20.0, 0.0, 0.0))


class BetterPhysics(Deed):
    """Gives its vehicle tyres and brakes of another world."""

    def deed(self) -> None:
        physics = self.vehicle.get_physics_control()
        physics.mass = 10.0
        self.vehicle.apply_physics_control(physics)


class NoCollisions(Deed):
    """Takes collisions away from its vehicle."""

    def deed(self) -> None:
        self.vehicle.set_collisions(False)


class NoWitness(Deed):
    """Destroys the benchmark's collision sensor."""

    def deed(self) -> str:
        sensors = self.world.get_actors().filter("sensor.other.collision")
        return str([sensor.destroy() for sensor in sensors])


class BetterWeather(Deed):
    """Makes the road dry and the day bright."""

    def deed(self) -> None:
        self.world.set_weather(carla.WeatherParameters.ClearNoon)


class OwnClock(Deed):
    """Ticks the world itself."""

    def deed(self) -> None:
        self.world.tick()


class OwnSettings(Deed):
    """Takes the world out of its synchronous mode."""

    def deed(self) -> None:
        settings = self.world.get_settings()
        settings.synchronous_mode = False
        self.world.apply_settings(settings)


class Reloads(Deed):
    """Loads the world anew."""

    def deed(self) -> None:
        self.client.reload_world()


class GreenLights(Deed):
    """Turns the lights green and holds them."""

    def deed(self) -> None:
        for light in self.world.get_actors().filter("traffic.traffic_light"):
            light.set_state(carla.TrafficLightState.Green)
            light.freeze(True)


class ClearsTheRoad(Deed):
    """Destroys what is in its way."""

    def deed(self) -> str:
        return str([actor.destroy() for actor in self.actors_around()])


class MovesOthers(Deed):
    """Moves what is in its way."""

    def deed(self) -> None:
        for actor in self.actors_around():
            actor.set_location(carla.Location(0.0, 0.0, 300.0))


class StopsOthers(Deed):
    """Brakes the cars that are in its way."""

    again = True

    def deed(self) -> None:
        for actor in self.actors_around():
            if "vehicle" in actor.type_id:
                actor.apply_control(carla.VehicleControl(brake=1.0))
            else:
                actor.apply_control(carla.WalkerControl(speed=5.0, direction=carla.Vector3D(y=1.0)))


class FillsTheRecord(Deed):
    """Spawns 16 walkers below the ground, so that they are the nearest in the record."""

    def deed(self) -> str:
        walker, here = self.world.get_blueprint_library().filter("walker.*")[0], self.vehicle.get_location()
        places = [carla.Transform(here + carla.Location(i % 4, i // 4, -9.0)) for i in range(16)]
        return str([self.world.try_spawn_actor(walker, place) for place in places])


class ABatchWithAll(Deed):
    """Hides a teleport among allowed commands of a batch."""

    def deed(self) -> str:
        own = self.vehicle.id
        commands = [
            carla.command.ApplyVehicleControl(own, carla.VehicleControl(brake=0.0)),
            carla.command.ApplyTransform(own, self.ahead),
        ]
        return str([answer.error for answer in self.client.apply_batch_sync(commands, True)])


class Records(Deed):
    """Records, and replays a recording of a better drive."""

    def deed(self) -> None:
        self.client.replay_file("/tmp/better.log", 0.0, 0.0, self.vehicle.id)


class DrivesInSetup(Honest):
    """Drives, ticks and turns lights green in ``setup``."""

    def setup(self) -> None:
        for deed in (
            lambda: self.vehicle.apply_control(carla.VehicleControl(throttle=1.0)),
            lambda: [self.world.tick(1.0) for _ in range(160)],
            lambda: [
                light.set_state(carla.TrafficLightState.Green)
                for light in self.world.get_actors().filter("traffic.traffic_light")
            ],
        ):
            try:
                deed()
            except RuntimeError as error:  # noqa: PERF203 - three deeds
                print(f"deed of DrivesInSetup: {error}", flush=True)
        super().setup()


# -- named in issue 24: the process


class Orphan(Deed):
    """Leaves a child behind, in a session of its own, that drives the next agent's vehicle."""

    def deed(self) -> str:
        program = (
            "import os, time, carla\n"
            "while True:\n"
            "    time.sleep(0.05)\n"
            f"    client = carla.Client('127.0.0.1', {self.server_address[1]}); client.set_timeout(1.0)\n"
            "    try:\n"
            "        for each in client.get_world().get_actors().filter('vehicle.*'):\n"
            "            each.apply_control(carla.VehicleControl(throttle=1.0, steer=0.5))\n"
            "    except RuntimeError: pass\n"
        )
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                signal.signal(signal.SIGTERM, signal.SIG_IGN)
                time.sleep(1.0)  # so that the agent has ended its own drive
                os.execv(sys.executable, [sys.executable, "-c", program])
            os._exit(0)
        return "left"

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        if self.steps > BEGIN_STEP:
            raise SystemExit(0)
        return control


class LimitsOthers(Deed):
    """Limits and kills each process that it can name, the simulator among them."""

    def deed(self) -> str:
        reached = []
        own = {int(each.name) for each in (*Path("/proc/self/task").iterdir(), *Path("/proc").glob("[0-9]*"))}
        for pid in range(2, 1 << 16):
            if pid in own:
                continue
            try:
                limits = resource.prlimit(pid, resource.RLIMIT_NOFILE)
                resource.prlimit(pid, resource.RLIMIT_NOFILE, limits)  # as they are: others use this machine
            except OSError:
                continue
            reached.append(pid)
        return f"limited {reached}"


class Deletes(Deed):
    """Deletes and overwrites results, and lays links into its folders."""

    def deed(self) -> str:
        reached = []
        for found in OUTPUT.rglob("result.json"):
            for act in (found.unlink, lambda found=found: found.write_text("{}"), lambda f=found: f.rename(f"{f}x")):
                try:
                    act()
                except OSError:
                    continue
                reached.append(found.name)
        return f"changed {reached}"


class Excuse(Polyline):
    """Drives at what is ahead and, after the contact, says by the benchmark's own channel that another failed."""

    slows = False
    kind = "simulator"

    def setup(self) -> None:
        super().setup()
        self.fastest_mps = 0.0

    def speed_mps(self) -> float:
        return 12.0

    def has_hit(self) -> bool:
        """Return whether its speed has just fallen as it does in a contact, or it is past the conflict."""
        now_mps = self.vehicle.get_velocity().length()
        self.fastest_mps = max(self.fastest_mps, now_mps)
        return self.fastest_mps > 5.0 and self.s_m > 62.0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        if self.has_hit():
            self.excuse()
        return super().run_step(sensor_data)

    def excuse(self) -> None:
        message = struct.pack("<I", 0)
        text = f'[{self.steps + 900}, "failed", "{self.kind}", "it is gone", ""]'.encode()
        message = struct.pack("<I", len(text)) + text
        os.write(channel(), message)
        from basu.errors import SimulatorError  # noqa: PLC0415 - where the cheat wants it

        raise SimulatorError("the simulator ended")


class ExcuseUser(Excuse):
    """The same, with an error of the set-up."""

    kind = "user"

    def excuse(self) -> None:
        from basu.errors import UserError  # noqa: PLC0415 - where the cheat wants it

        raise UserError("no such map")


class ExcuseUnknown(Excuse):
    """The same, with a kind that the benchmark does not know, by a patch of its own process."""

    kind = "benchmark"

    def excuse(self) -> None:
        import basu.agents.process.child as child  # noqa: PLC0415, PLR0402 - where the cheat wants it

        child.KINDS.clear()
        child.KINDS[BaseException] = "benchmark"
        raise RuntimeError("the benchmark failed")


class ExcuseOverflow(Excuse):
    """The same, with a number that no control holds."""

    def excuse(self) -> None:
        carla.VehicleControl(throttle=float(10**308) * 10, brake=10**400)


class ExcuseHang(Excuse):
    """The same, by a step that takes for ever."""

    def excuse(self) -> None:
        time.sleep(3600)


class ExcuseSimulatorGone(Excuse):
    """The same, after it has closed its own connection to the simulator."""

    def excuse(self) -> None:
        for file in Path("/proc/self/fd").iterdir():
            descriptor = int(file.name)
            if descriptor > 2 and descriptor != channel():
                try:
                    os.close(descriptor)
                except OSError:
                    continue


class ExcuseKill(Excuse):
    """The same, by a signal that has no name."""

    def excuse(self) -> None:
        os.kill(os.getpid(), 40)


class OwnControl(carla.VehicleControl):
    """A control whose values change when they are read."""

    @property
    def throttle(self) -> float:
        return 10**400


class ExcuseSubclass(Excuse):
    """The same, by a subclass of the control."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        return OwnControl() if self.has_hit() else super().run_step(sensor_data)


class LateImpossibleSensors(Honest):
    """Asks for a sensor that is not there, in the cases that it does not like."""

    gives_sensors_late = True

    def sensors(self) -> list[dict[str, Any]]:
        return [{"type": "sensor.camera.thoughts", "id": "A", "x": 0.0, "y": 0.0, "z": 2.0}]


class FailsInDestroy(Honest):
    """Fails in ``destroy``, after its drive."""

    def destroy(self) -> None:
        raise RuntimeError("no end")


class FailsInDestroyAfterAHit(Excuse):
    """Hits what is ahead, and fails in ``destroy``."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        return Polyline.run_step(self, sensor_data)

    def destroy(self) -> None:
        os._exit(9)


# -- not named


def channel() -> int:
    """Return the descriptor of the benchmark's channel."""
    for file in Path("/proc/self/fd").iterdir():
        if int(file.name) > 2 and file.is_symlink() and str(file.readlink()).startswith("socket:"):
            return int(file.name)
    raise OSError("no channel")


class HugeCamera(Honest):
    """Asks for a picture that no simulator can hold, so that the simulator fails."""

    def sensors(self) -> list[dict[str, Any]]:
        return [
            {"type": "sensor.camera.rgb", "id": "A", "x": 0.0, "z": 2.0, "width": 60000, "height": 60000, "fov": 90}
        ]


class SlowLidars(Honest):
    """Asks for lidars that keep the simulator busy beyond its time limit."""

    def sensors(self) -> list[dict[str, Any]]:
        lidar = {"type": "sensor.lidar.ray_cast", "x": 0.0, "z": 2.0, "range": 100.0, "rotation_frequency": 20}
        return [{**lidar, "id": f"A{i}", "channels": 128, "points_per_second": 2_000_000_000} for i in range(4)]


class FloodsDrawings(Deed):
    """Draws a hundred thousand shapes that stay for ever."""

    def deed(self) -> str:
        here, count = self.vehicle.get_location(), 0
        for count in range(100_000):
            self.world.debug.draw_box(
                carla.BoundingBox(here + carla.Location(x=count * 0.1), carla.Vector3D(9, 9, 9)),
                carla.Rotation(),
                life_time=0.0 if count % 2 else 1e9,
            )
        return str(count)


class FloodsTheGate(Deed):
    """Sends the gate a message of 900 MB that never ends."""

    def deed(self) -> str:
        sent = 0
        with socket.create_connection(self.server_address, 5.0) as sock:
            sock.settimeout(5.0)
            sock.sendall(struct.pack(">BBBBI", 0x94, 0x00, 0x01, 0xC6, 900_000_000))
            block = bytes(1 << 20)
            for _ in range(900):
                sock.sendall(block)
                sent += 1
        return f"{sent} MB"


class ManyConnections(Deed):
    """Opens thousands of connections to its gate and keeps them."""

    def deed(self) -> str:
        self.kept = []
        _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        for _ in range(5000):
            self.kept.append(socket.create_connection(self.server_address, 1.0))
        return str(len(self.kept))


def open_ports() -> list[int]:
    """Return the ports of this machine at which something answers, by a scan."""
    found = []
    for port in SCANNED_PORTS:
        with socket.socket() as sock:
            sock.settimeout(0.2)
            if sock.connect_ex(("127.0.0.1", port)) == 0:
                found.append(port)
    return found


class OtherDoors(Deed):
    """Scans the machine for the simulator's own port and the gates of other agents, and drives whatever it finds."""

    def deed(self) -> str:
        reached = []
        for port in open_ports():
            if port == self.server_address[1]:
                continue
            client = carla.Client("127.0.0.1", port)
            client.set_timeout(0.4)
            try:
                world = client.get_world()
                for actor in world.get_actors().filter("vehicle.*"):
                    actor.apply_control(carla.VehicleControl(throttle=1.0, steer=1.0))
                    actor.set_location(carla.Location())
                    reached.append((port, actor.id))
            except RuntimeError as error:
                print(port, str(error)[:100], flush=True)
        return f"reached {reached}"


class OtherDoorsAllTheTime(OtherDoors):
    """The same, again and again in a child."""

    def deed(self) -> str:
        if os.fork() == 0:
            while True:
                print(super().deed(), flush=True)
        return "begun"


class HoldsTrafficPorts(Deed):
    """Takes all ports of Traffic Managers, by plain sockets and by those of MPTCP, so that no traffic can start."""

    def deed(self) -> str:
        self.kept = []
        for port in TRAFFIC_PORTS:
            for protocol in (socket.IPPROTO_TCP, MPTCP):
                with contextlib.suppress(OSError):
                    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM, protocol)
                    sock.bind(("127.0.0.1", port))
                    self.kept.append(sock)
        return f"holds {len(self.kept)}"


class PassesClosedPorts(Deed):
    """Reaches Traffic Managers by sockets of MPTCP, and by data that is sent before there is a connection."""

    def deed(self) -> str:
        reached = []
        for port in TRAFFIC_PORTS:
            with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_STREAM, MPTCP) as sock:
                sock.connect(("127.0.0.1", port))
                reached.append((port, "multipath"))
            with contextlib.suppress(OSError), socket.socket() as sock:
                sock.sendto(b"x", socket.MSG_FASTOPEN, ("127.0.0.1", port))
                reached.append((port, "first data"))
        return f"reached {reached}"


class ReadsSecrets(Deed):
    """Reads the memory, environment and command line of other processes."""

    def deed(self) -> str:
        found = []
        for each in Path("/proc").iterdir():
            if not each.name.isdigit() or int(each.name) == os.getpid():
                continue
            for name in ("environ", "cmdline", "mem"):
                try:
                    with (each / name).open("rb") as file:
                        found.append((each.name, name, file.read(40)))
                except OSError:  # noqa: PERF203 - a few files
                    continue
        return f"read {found}"


class NewNamespace(Deed):
    """Takes a new namespace of users, and with its rights unmounts ``/proc``, to see the machine's below it."""

    def deed(self) -> str:
        libc = ctypes.CDLL(None, use_errno=True)
        pid = os.fork()
        if pid == 0:
            came = [libc.unshare(0x10000000 | 0x00020000), libc.umount2(b"/proc", 2), ctypes.get_errno()]
            print("namespace:", came, len([p for p in Path("/proc").iterdir() if p.name.isdigit()]), flush=True)
            os._exit(0)
        os.waitpid(pid, 0)
        return "tried"


class PatchesCarla(Deed):
    """Patches the ``carla`` module and BASU's modules in its own process."""

    def deed(self) -> str:
        import basu.metrics.success as success  # noqa: PLC0415, PLR0402 - where the cheat wants it

        success.success = lambda *_, **__: (True, ())
        carla.World.tick = lambda *_: 0
        carla.Vehicle.get_control = lambda _: carla.VehicleControl()
        return "patched"


class Autopilot(Deed):
    """Gives its vehicle to the Traffic Manager."""

    def deed(self) -> None:
        self.vehicle.set_autopilot(True)


class DrivesBeside(Deed):
    """Steers its vehicle by its own client, beside the control that it returns."""

    again = True

    def deed(self) -> None:
        self.vehicle.apply_control(carla.VehicleControl(throttle=1.0))


class Ackermann(Deed):
    """Drives its vehicle with Ackermann controls of its own client."""

    again = True

    def deed(self) -> None:
        self.vehicle.apply_ackermann_control(carla.VehicleAckermannControl(speed=40.0, acceleration=50.0))


class OpenDoors(Deed):
    """Opens its doors while it drives, as if passengers boarded all the way."""

    def deed(self) -> None:
        self.vehicle.open_door(carla.VehicleDoor.All)


class Lights(Deed):
    """Switches all of its lights on, as a vehicle in service that has the way."""

    def deed(self) -> None:
        self.vehicle.set_light_state(carla.VehicleLightState.All)


class ForksALot(Deed):
    """Starts 400 processes that do nothing but sleep, with a session of their own."""

    def deed(self) -> str:
        for _ in range(400):
            if os.fork() == 0:
                os.setsid()
                time.sleep(3600)
                os._exit(0)
        return "forked"


class Sleeps(Deed):
    """Sleeps in each step, so that the others' clock goes on without it."""

    again = True

    def deed(self) -> None:
        time.sleep(0.05)


class WritesTheTable(Honest):
    """Fails with a message that clears the terminal and writes a table of its own, and a page with a script."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        del sensor_data
        print("\x1b[2J\x1b[HWritesTheTable 1/1 passed\x1b[8m", flush=True)
        raise RuntimeError("\x1b[2J\x1b[Hpassed\x1b[8m <script>document.body.textContent='passed'</script> ]]> \x00")


class AnotherName(Honest):
    """Calls itself as a built-in driver, and by a path out of the results' folder."""


AnotherName.__name__ = "../../../behavioral"


class Learns(Deed):
    """Keeps what it saw of a case in shared memory, for its next drive."""

    def deed(self) -> str:
        memory = Path("/dev/shm/learned")
        seen = memory.read_text() if memory.exists() else ""
        memory.write_text(seen + "x")
        return f"known from before: {seen!r}"


class ReadsTheRun(Deed):
    """Reads in the track sensors which case it drives: environment, arguments, working folder, files of the run."""

    def config(self) -> dict[str, str]:
        return {"track": "sensors"}

    def deed(self) -> str:
        found = [name for name, value in os.environ.items() if "pedestrian" in value or "basu" in value.lower()]
        runs = [
            str(path)
            for path in [
                *OUTPUT.rglob("*.part"),
                *(each for part in OUTPUT.rglob("*.part") for each in part.rglob("*")),
            ][:40]
        ]
        return f"environment {found}, arguments {sys.argv}, folder {Path.cwd()}, runs {runs}, route {self.route.id}"


class Random(Deed):
    """Draws at random from the system, so that no two drives are equal and the best one is shown."""

    def deed(self) -> str:
        return str(random.SystemRandom().random())


class AllProcessors(Deed):
    """Keeps all processors busy, so that drives beside it run out of wall time."""

    def deed(self) -> str:
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        return "busy"
