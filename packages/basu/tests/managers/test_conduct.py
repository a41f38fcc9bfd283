"""Claims about agents that cheat with a client of their own: the gate refuses it, and the drive goes on unchanged.

The drivers are real and the simulator is live.
"""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu import simulator as simulator_module
from basu.agents.process.gate import Gates, Relay
from basu.cli import main
from basu.errors import AgentCrashedError, UserError
from basu.managers.base_manager import WorldChanges
from basu.managers.conduct import Conduct, is_same_control
from basu.records.history.files import read_history
from basu.running import run_player
from basu.running.scenario_runs import player
from basu.simulator import OwnServer, Simulator, connect, linden_command
from cheating_agent import cheating_agent
from servers import RunningServer

LIGHT = "self.world.get_actors().filter('traffic.traffic_light')[0]"
DEEDS = {
    "set_actor_transform": "self.vehicle.set_transform(self.route.waypoints[-1].transform)",
    "set_actor_location": "self.vehicle.set_location(carla.Location())",
    "set_actor_target_velocity": "self.vehicle.set_target_velocity(carla.Vector3D(30.0, 0.0, 0.0))",
    "enable_actor_constant_velocity": "self.vehicle.enable_constant_velocity(carla.Vector3D(30.0, 0.0, 0.0))",
    "add_actor_impulse": "self.vehicle.add_impulse(carla.Vector3D(90000.0, 0.0, 0.0))",
    "add_actor_force": "self.vehicle.add_force(carla.Vector3D(90000.0, 0.0, 0.0))",
    "set_weather_parameters": "self.world.set_weather(carla.WeatherParameters.HardRainNight)",
    "apply_physics_control": "self.vehicle.apply_physics_control(carla.VehiclePhysicsControl(mass=10.0))",
    "set_actor_collisions": "self.vehicle.set_collisions(False)",
    "set_actor_simulate_physics": "self.vehicle.set_simulate_physics(False)",
    "is_traffic_manager_running": "self.vehicle.set_autopilot(True)",
    "destroy_actor": "[s.destroy() for s in self.world.get_actors().filter('sensor.other.collision')]",
    "set_traffic_light_state": f"{LIGHT}.set_state(carla.TrafficLightState.Green)",
    "set_traffic_light_green_time": f"{LIGHT}.set_green_time(99.0)",
    "freeze_all_traffic_lights": f"{LIGHT}.freeze(True)",
    "reset_all_traffic_lights": "self.world.reset_all_traffic_lights()",
    "tick_cue": "self.world.tick()",
    "load_new_episode": "self.client.reload_world()",
    "set_episode_settings": "self.world.apply_settings(self.world.get_settings())",
    "start_recorder": "self.client.start_recorder('mine.log')",
    "apply_batch": "self.client.apply_batch_sync([carla.command.DestroyActor(self.vehicle.id)], True)",
    "spawn_actor": "self.world.spawn_actor(self.world.get_blueprint_library()[0], carla.Transform())",
}
AMONG_OTHERS = {
    "destroy_actor": "self.others()[0].destroy()",
    "set_actor_transform": "self.others()[0].set_transform(self.route.waypoints[-1].transform)",
    "apply_control_to_vehicle": "self.others()[0].apply_control(carla.VehicleControl(throttle=1.0, steer=1.0))",
}
CHEAT = """def cheat(self):
        deeds = {deeds!r}
        if self.steps <= len(deeds):
            try:
                exec(deeds[self.steps - 1])
            except RuntimeError as error:
                assert "refused by the gate" in str(error), error
"""


def cheat(folder: Path, deeds: dict[str, str]) -> Path:
    """An agent that tries one deed a step."""
    more = CHEAT.format(deeds=list(deeds.values()))
    return cheating_agent(folder, "cheat", when="> 0", deed="self.cheat()", more=more)


Ours = Callable[[object], AbstractContextManager[Simulator]]


@pytest.fixture(scope="module")
def ours(simulator: RunningServer) -> Ours:
    """Return a ``simulator_for`` with the session's server in place of one of the command's own, behind a relay."""
    address = ("127.0.0.1", simulator.port)
    client = connect(*address, 20.0)

    @contextmanager
    def simulator_for(_: object) -> Iterator[Simulator]:
        relay = Relay([*linden_command(), "gate", "--port", str(simulator.port)])
        try:
            yield Simulator(client, address, own=True, why_gone=lambda: None, ended=lambda: False, gates=Gates(relay))
        finally:
            relay.end()

    return simulator_for


def result_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "latest" / "result.json").read_text(encoding="utf-8"))
    return found


def test_nothing_that_an_agent_tries_changes_its_drive(
    ours: Ours, route_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_player, "simulator_for", ours)
    options = ["--routes", str(route_file), "--output", str(tmp_path / "runs"), "--stop-after", "3"]
    main(["run", str(cheating_agent(tmp_path, "honest", when="> 999", deed="pass")), *options])
    honest, alone = result_of(tmp_path / "runs"), read_history(tmp_path / "runs" / "latest")
    main(["run", str(cheat(tmp_path, DEEDS)), *options])
    result, history = result_of(tmp_path / "runs"), read_history(tmp_path / "runs" / "latest")
    assert (result["status"], result["message"]) == (honest["status"], honest["message"])
    assert result["scores"] == honest["scores"]
    assert history.frames.tolist() == alone.frames.tolist()
    assert set(result["meta"]["access"]["refused"]) >= set(DEEDS)
    assert honest["meta"]["access"] == {"track": "world", "open": False, "refused": {}}


def test_nothing_that_an_agent_tries_changes_others(
    ours: Ours, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(player, "simulator_for", ours)
    agents = [cheating_agent(tmp_path, "honest", when="> 999", deed="pass"), cheat(tmp_path, AMONG_OTHERS)]
    options = [word for agent in agents for word in ("--agent", str(agent))]
    main(
        ["scenario", "run", "follow_leading_vehicle_1", *options, "--output", str(tmp_path / "runs"), "--workers", "1"]
    )
    found = {
        path.parent.parent.name: (json.loads(path.read_text(encoding="utf-8")), read_history(path.parent))
        for path in (tmp_path / "runs" / "latest").glob("*/*/result.json")
    }
    (honest, alone), (result, history) = found["honest"], found["cheat"]
    assert result["case"]["verdict"] == honest["case"]["verdict"]
    assert history.frames.tolist() == alone.frames.tolist()
    assert set(result["meta"]["access"]["refused"]) == set(AMONG_OTHERS)


@pytest.mark.usefixtures("one_server")
def test_a_server_of_our_own_has_the_gate_in_itself_and_no_door_beside_it(route_file: Path, tmp_path: Path) -> None:
    connected = simulator_module.connect

    def noted(host: str, port: int, timeout_s: float) -> carla.Client:
        (tmp_path / "port").write_text(str(port))
        return connected(host, port, timeout_s)

    more = f"""def walk_round(self):
        with open({str(tmp_path / "port")!r}) as file:
            port = int(file.read())
        assert port != self.server_address[1]
        for each in (self.server_address[1], port):
            client = carla.Client('127.0.0.1', each)
            client.set_timeout(0.5)
            try:
                client.get_world().tick()
            except RuntimeError as error:
                print('not let in at', each, error)
                continue
            raise SystemExit('walked round the gate')
"""
    agent = cheating_agent(tmp_path, "cheat", when="== 2", deed="self.walk_round()", more=more)
    options = ["--routes", str(route_file), "--output", str(tmp_path / "runs"), "--stop-after", "1"]
    with pytest.MonkeyPatch.context() as patch:  # undone before the server that is kept is given back
        patch.setattr(simulator_module, "connect", noted)
        main(["run", str(agent), *options])
    result = result_of(tmp_path / "runs")
    assert result["status"] == "Stopped", result["message"]
    assert result["meta"]["access"]["refused"]["tick_cue"] == 1


@pytest.mark.parametrize("where", ["in the server", "before it"])
def test_an_agent_goes_through_no_gate_but_its_own(simulator: RunningServer, where: str) -> None:
    """An agent that scanned the machine could control the vehicle of an agent that drove beside it."""
    own = OwnServer(gates=True) if where == "in the server" else None
    keeper = own or Relay([*linden_command(), "gate", "--port", str(simulator.port)])
    try:
        with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as agent:
            address = Gates(keeper).open("world", 1, [], agent.pid).address
            with socket.create_connection(address) as other:
                assert other.recv(1) == b""
            agent.communicate(b"\n")
        gates = Gates(keeper)
        first, second = (gates.open("world", vehicle, [], os.getpid()) for vehicle in (1, 2))
        for gate in (first, second):  # an agent of each vehicle at once
            connect(*gate.address, 20.0).get_server_version()
        assert first.close() == {}
        with pytest.raises(UserError, match="no simulator answers"):
            connect(*first.address, 1.0)
        connect(*second.address, 20.0).get_server_version()
        assert second.close() == {}
    finally:
        keeper.end()


def test_a_step_with_another_control_has_a_sentence() -> None:
    given, had = carla.VehicleControl(brake=1.0), carla.VehicleControl(throttle=1.0)
    run: Any = SimpleNamespace(changes=WorldChanges(control=given), vehicle=SimpleNamespace(get_control=lambda: had))
    frame: Any = SimpleNamespace(server_frame=7)
    conduct = Conduct("Cheat")
    conduct.begin(run)
    with pytest.raises(AgentCrashedError, match=r"had throttle 1\.00, .* instead of throttle 0\.00, .* brake 1\.00 in"):
        conduct.before(frame)


def test_controls_are_compared_but_for_rounding_and_gears() -> None:
    given = carla.VehicleControl(throttle=0.1, steer=-0.7, brake=0.3)
    assert is_same_control(given, carla.VehicleControl(throttle=0.10000001, steer=-0.7, brake=0.3, gear=3))
    assert not is_same_control(given, carla.VehicleControl(throttle=0.1, steer=-0.7, brake=0.3, reverse=True))
