"""Claims about the agent's calls: whatever it does, it gets its own kind of failure and a sentence."""

import math
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.loader import LoadedAgent
from basu.errors import AgentCrashedError, AgentInvalidControlError, AgentTimedOutError, UserError
from basu.managers.agents_manager import AgentsManager
from basu.managers.base_manager import Run
from basu.routing.route_file import RoutePoint
from fakes.drives import straight_route

FRAME: Any = SimpleNamespace(tick=0, server_frame=3)


class Docile(AutonomousAgent):
    """Returns its given answer."""

    answer: Any = carla.VehicleControl(throttle=0.5)

    def setup(self) -> None:
        self.seen: list[Any] = []

    def run_step(self, sensor_data: Any) -> Any:
        self.seen.append(sensor_data)
        return self.answer() if callable(self.answer) else self.answer

    def config(self) -> Any:
        return {}


def made(agent_class: type[AutonomousAgent], limit_s: float = 30.0, routes: str | None = None) -> AgentsManager:
    manager = AgentsManager(LoadedAgent(agent_class, "an agent", None), step_limit_s=limit_s, routes=routes)
    manager.setup(
        Run(
            client=None,
            world=None,
            carla_map=None,
            vehicle=SimpleNamespace(id=1),
            route=straight_route(),
            config=manager.config,
            step_s=0.05,
            seed=0,
            timeout_s=1.0,
            folder=Path(),
        )
    )
    return manager


def answering(value: Any) -> type[Docile]:
    return type("Answering", (Docile,), {"answer": staticmethod(value) if callable(value) else value})


def raising(error: BaseException) -> Any:
    def fail() -> None:
        raise error

    return fail


def test_the_answer_becomes_the_control() -> None:
    manager = made(Docile)
    assert manager.control.brake == 1.0  # before the first answer
    manager.perceive({"GNSS": (3, "fix")})
    manager.tick(FRAME)
    assert manager.control.throttle == pytest.approx(0.5)
    assert manager._agent.agent.seen == [{"GNSS": (3, "fix")}]


def test_the_agent_is_bound_before_its_setup() -> None:
    class Looks(Docile):
        def setup(self) -> None:
            assert self.route is not None
            assert self.config_values["routes"] == "mine.xml"
            self.step_at_setup_s = self.time_step_s

    assert made(Looks, routes="mine.xml")._agent.agent.step_at_setup_s == 0.05


def test_values_out_of_range_are_brought_into_it_as_carla_does() -> None:
    manager = made(answering(carla.VehicleControl(throttle=1.5, steer=-3.0, brake=-0.5)))
    manager.tick(FRAME)
    assert (manager.control.throttle, manager.control.steer, manager.control.brake) == (1.0, -1.0, 0.0)


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (None, "returned None; it must return a carla.VehicleControl"),
        (0.5, "returned a float"),
        ({"throttle": 1.0}, "returned a dict"),
        (carla.VehicleControl(steer=math.nan), "with steer nan"),
        (carla.VehicleControl(throttle=math.inf), "with throttle inf"),
    ],
)
def test_nonsense_is_an_invalid_control(answer: Any, sentence: str) -> None:
    with pytest.raises(AgentInvalidControlError, match=sentence):
        made(answering(answer)).tick(FRAME)


@pytest.mark.parametrize("error", [ValueError("no lane"), SystemExit(3), RuntimeError("time-out")])
def test_whatever_the_agent_raises_is_a_crash_of_the_agent(error: BaseException) -> None:
    with pytest.raises(AgentCrashedError, match=rf"run_step\(\) of Answering raised {type(error).__name__}: .* \(line"):
        made(answering(raising(error))).tick(FRAME)


def test_a_user_at_the_keyboard_is_not_the_agent() -> None:
    with pytest.raises(KeyboardInterrupt):
        made(answering(raising(KeyboardInterrupt()))).tick(FRAME)


def test_sleeping_in_a_step_is_a_time_out() -> None:
    with pytest.raises(AgentTimedOutError, match=r"run_step\(\) of Answering took longer than its limit of 0.1 s"):
        made(answering(lambda: time.sleep(3600.0)), limit_s=0.1).tick(FRAME)


def test_a_busy_loop_in_a_step_is_a_time_out() -> None:
    def loop() -> None:
        while sys.version_info:
            pass

    with pytest.raises(AgentTimedOutError):
        made(answering(loop), limit_s=0.1).tick(FRAME)


def test_a_setup_that_raises_is_a_crash_of_the_agent() -> None:
    class Fails(Docile):
        def setup(self) -> None:
            raise FileNotFoundError("weights.pt")

    with pytest.raises(AgentCrashedError, match=r"setup\(\) of Fails raised FileNotFoundError: weights.pt"):
        made(Fails)


def test_a_config_that_makes_no_sense_is_a_matter_of_the_set_up() -> None:
    class Odd(Docile):
        def config(self) -> Any:
            return {"vehicel": "x"}

    with pytest.raises(UserError, match="did you mean 'vehicle'"):
        made(Odd)


def test_destroy_is_called_once_and_only_for_a_bound_agent() -> None:
    ended = []

    class Ends(Docile):
        def destroy(self) -> None:
            ended.append(1)

    AgentsManager(LoadedAgent(Ends, "e", None), step_limit_s=1.0, routes=None).close()
    assert ended == []
    manager = made(Ends)
    manager.close()
    manager.close()
    assert ended == [1]


def test_a_plan_of_the_agents_own_may_be_spelled_in_several_ways() -> None:
    class Plans(Docile):
        def get_initial_route_locations(self) -> Any:
            return [
                carla.Location(1.0, 2.0, 3.0),
                carla.Transform(carla.Location(4.0, 5.0, 6.0), carla.Rotation(yaw=180.0)),
                (7, 8, 9),
            ]

    first, second, third = made(Plans).own_route() or ()
    assert first == RoutePoint(1.0, 2.0, 3.0)
    assert (second.x_m, second.yaw_rad) == (4.0, pytest.approx(math.pi))
    assert third == RoutePoint(7.0, 8.0, 9.0)
    assert made(Docile).own_route() is None


def test_a_plan_that_is_none_is_the_agents_failure() -> None:
    class Plans(Docile):
        def get_initial_route_locations(self) -> Any:
            return ["the station", "the library"]

    with pytest.raises(AgentCrashedError, match="what is no list of locations"):
        made(Plans).own_route()


def sensing(given: Any, file: str | None = None) -> AgentsManager:
    wishes = {} if file is None else {"sensors": file}
    return made(type("Sensing", (Docile,), {"sensors": lambda _: given, "config": lambda _: wishes}))


def test_an_agent_may_give_its_sensors_itself_or_leave_them_to_the_file() -> None:
    assert made(Docile).own_sensors() is None
    (camera,) = sensing([{"type": "sensor.camera.rgb", "id": "FRONT", "z": 2.4, "width": 64}]).own_sensors() or ()
    assert (camera.id, camera.z_m, camera.attributes) == ("FRONT", 2.4, (("image_size_x", "64"),))


@pytest.mark.parametrize(
    ("given", "file", "sentence"),
    [
        ("config/rig.json", None, r"sensors\(\) of Sensing returned str; it must return a list of dicts"),
        ({"type": "sensor.other.gnss"}, None, "returned dict"),
        (7, None, "returned int"),
        ([{"type": "sensor.other.gnss"}], None, r"sensors\(\) of Sensing: sensor 1 needs a 'type' and an 'id'"),
        ([], "config/rig.json", "gives a sensor set, and config\\(\\) the file config/rig.json; give one of them"),
    ],
)
def test_a_sensor_set_that_is_none_gets_a_sentence(given: Any, file: str | None, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        sensing(given, file).own_sensors()
