"""Claims about driving an agent of the leaderboard: the order of its calls, its inputs, and the party at fault."""

import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

from basu.agents.loader import LoadedAgent
from basu.errors import AgentCrashedError, AgentInvalidControlError, UserError
from basu.managers.agents_manager import AgentsManager
from basu.managers.base_manager import Run
from basu_leaderboard.adapted_agent import adapted
from basu_leaderboard.foreign_class import Dialect, ForeignAgent
from basu_leaderboard.provided.carla_data_provider import CarlaDataProvider, GameTime
from basu_leaderboard.provided.leaderboard_agent import AutonomousAgent
from basu_leaderboard.provided.scenario_runner_agent import AutonomousAgent as ScenarioRunnersAgent
from fakes.one_road import OPENDRIVE, one_road, way_along

SPEEDOMETER = {"type": "sensor.speedometer", "id": "SPEED", "reading_frequency": 20}
OPENDRIVE_MAP = {"type": "sensor.opendrive_map", "id": "MAP", "reading_frequency": 1}


class World:
    """As much of a world as an adapter looks at."""

    frame = 500

    def get_map(self) -> carla.Map:
        return TOWN

    def get_snapshot(self) -> Any:
        timestamp = SimpleNamespace(frame=self.frame, delta_seconds=0.05, elapsed_seconds=self.frame * 0.05)
        return SimpleNamespace(frame=self.frame, timestamp=timestamp)


class Vehicle:
    id = 7
    attributes = {"role_name": "hero"}  # noqa: RUF012 - as an actor has it

    def get_velocity(self) -> carla.Vector3D:
        return carla.Vector3D(0.0, 5.0, 1.0)

    def get_transform(self) -> carla.Transform:
        return carla.Transform(carla.Location(2.0, 1.75, 0.0), carla.Rotation(yaw=90.0))


class Told(AutonomousAgent):
    """Writes down its calls."""

    answer: Any = carla.VehicleControl(throttle=0.5, manual_gear_shift=True)
    asked: list[str]
    sensor_set: Any = (SPEEDOMETER, OPENDRIVE_MAP, {"type": "sensor.other.gnss", "id": "GPS"})

    def __init__(self, host: str, port: int, debug: int) -> None:
        super().__init__(host, port, bool(debug))
        self.asked = [f"made for {host}:{port}"]

    def setup(self, path_to_conf_file: str) -> None:
        hero = CarlaDataProvider.get_hero_actor()
        assert hero is not None
        self.asked.append(f"set up with {path_to_conf_file!r} for {hero.id}")

    def set_global_plan(self, global_plan_gps: Any, global_plan_world_coord: Any) -> None:
        super().set_global_plan(global_plan_gps, global_plan_world_coord)
        self.dense = global_plan_world_coord
        self.asked.append(f"plan of {len(global_plan_gps)} points")

    def sensors(self) -> Any:
        self.asked.append("sensors")
        return self.sensor_set

    def run_step(self, input_data: Any, timestamp: float) -> Any:
        self.seen, self.at = input_data, timestamp
        return self.answer

    def destroy(self) -> None:
        self.asked.append("destroyed")


TOWN = one_road()


@pytest.fixture(autouse=True)
def afterwards() -> Iterator[None]:
    yield
    CarlaDataProvider.cleanup()
    GameTime.restart()


def begun(
    agent_class: type[Any], dialect: Dialect = Dialect.LEADERBOARD_2, conf_file: str | None = None
) -> tuple[AgentsManager, World]:
    """An agent that is set up in a world of one road."""
    loaded = LoadedAgent(adapted(ForeignAgent(agent_class, dialect), conf_file), "an agent", None)
    manager = AgentsManager(loaded, step_limit_s=30.0, routes=None)
    world: Any = World()
    run = Run(
        client=None,
        world=world,
        carla_map=TOWN,
        vehicle=Vehicle(),
        route=way_along(TOWN),
        config=manager.config,
        step_s=0.05,
        seed=0,
        timeout_s=1.0,
        folder=None,  # type: ignore[arg-type]  # nothing is written
        server_address=("localhost", 4711),
    )
    manager.setup(run)
    return manager, world


def inside(manager: AgentsManager) -> Any:
    """The agent of theirs."""
    return manager._agent.agent._agent


def test_the_calls_come_in_the_order_of_the_leaderboard() -> None:
    manager, _ = begun(Told, conf_file="weights.pth")
    agent = inside(manager)
    assert manager.own_sensors() == ()
    (gnss,) = manager.late_sensors()
    manager.close()
    assert gnss.id == "GPS"
    assert agent.asked == [
        "made for localhost:4711",
        "plan of 41 points",
        "set up with 'weights.pth' for 7",
        "sensors",
        "destroyed",
    ]


def test_agents_of_the_first_leaderboard_are_set_up_before_their_plan() -> None:
    asked = []

    class First(ScenarioRunnersAgent):
        def setup(self, path_to_conf_file: str) -> None:
            asked.append(f"set up with {path_to_conf_file!r}")

        def set_global_plan(self, *plan: Any) -> None:
            super().set_global_plan(*plan)
            asked.append("plan")

    manager, _ = begun(First, Dialect.LEADERBOARD_1)
    assert asked == ["set up with ''", "plan"]
    assert 2 < len(inside(manager)._global_plan) < 41  # ScenarioRunner's base class keeps what is a metre apart


def test_the_base_class_of_the_leaderboard_thins_the_plan_to_its_ends() -> None:
    manager, _ = begun(Told)
    agent = inside(manager)
    assert len(agent.dense) == 41
    (first, _), (last, _) = agent._global_plan_world_coord
    assert (first.location.x, last.location.x) == pytest.approx((2.0, 42.0), abs=0.01)
    assert set(agent._global_plan[0][0]) == {"lat", "lon", "z"}


def test_a_step_has_the_measurements_of_its_frame_and_the_time_since_the_beginning() -> None:
    manager, world = begun(Told)
    manager.late_sensors()
    manager.perceive({"GPS": (500, "a fix")})
    manager.tick(SimpleNamespace(tick=0, server_frame=0))
    agent = inside(manager)
    assert agent.at == pytest.approx(0.05)
    assert agent.seen["GPS"] == (500, "a fix")
    frame, speed = agent.seen["SPEED"]
    assert (frame, speed) == (500, {"speed": pytest.approx(5.0)})  # along the yaw of 90 degrees, none of it upwards
    assert agent.seen["MAP"] == (500, {"opendrive": TOWN.to_opendrive()})
    assert "OneRoad" in OPENDRIVE
    world.frame += 1
    manager.tick(SimpleNamespace(tick=1, server_frame=1))
    assert agent.at == pytest.approx(0.1)


def test_gears_are_the_simulators_as_in_the_leaderboard() -> None:
    manager, _ = begun(Told)
    manager.late_sensors()
    manager.tick(SimpleNamespace(tick=0, server_frame=0))
    assert manager.control.throttle == pytest.approx(0.5)
    assert not manager.control.manual_gear_shift


@pytest.mark.parametrize("answer", [None, 0.5, (0.0, 1.0, 0.0), {"throttle": 1.0}])
def test_an_answer_that_is_no_control_is_the_agents(answer: Any) -> None:
    manager, _ = begun(type("Odd", (Told,), {"answer": answer}))
    manager.late_sensors()
    with pytest.raises(AgentInvalidControlError, match=r"run_step\(\) of Odd returned .* must return a carla"):
        manager.tick(SimpleNamespace(tick=0, server_frame=0))


@pytest.mark.parametrize("method", ["__init__", "setup", "set_global_plan", "sensors", "run_step", "destroy"])
@pytest.mark.parametrize("error", [ValueError("no lane"), SystemExit(1)])
def test_whatever_raises_in_it_is_its_own(method: str, error: BaseException) -> None:
    def fail(*_: Any) -> None:
        raise error

    def live() -> None:
        manager, _ = begun(type("Bad", (Told,), {method: fail}))
        manager.late_sensors()
        manager.tick(SimpleNamespace(tick=0, server_frame=0))
        manager.close()

    with pytest.raises(AgentCrashedError, match=rf"\(\) of Bad raised {type(error).__name__}: .*test_adapted_agent.py"):
        live()


@pytest.mark.parametrize(
    ("sensor_set", "sentence"),
    [
        (None, "returned None; it must return a list of dicts"),
        ("sensors", "returned str"),
        ([7], "sensor 1 needs a 'type' and an 'id'"),
        ([{"type": "sensor.camera.rgb", "id": "A"}], "sensor 'A' .* lacks its field 'width'"),
        ([{"type": "sensor.other.gnss", "id": "A", "x": "far"}], "sensor 'A' has x = 'far'; it must be a number"),
        ([{"type": "sensor.other.gnss", "id": "A"}] * 2, "the id 'A' is given twice"),
        ([SPEEDOMETER, {"type": "sensor.other.gnss", "id": "SPEED"}], "the id 'SPEED' is given twice"),
    ],
)
def test_a_sensor_set_that_is_none_gets_a_sentence(sensor_set: Any, sentence: str) -> None:
    manager, _ = begun(type("Blind", (Told,), {"sensor_set": sensor_set}))
    with pytest.raises(UserError, match=rf"sensors\(\) of Blind.*{sentence}"):
        manager.late_sensors()


def test_the_world_is_taken_away_even_from_an_agent_that_fails_to_end() -> None:
    def fail(_: Any) -> None:
        raise OSError("the window is gone")

    manager, _ = begun(type("Stuck", (Told,), {"destroy": fail}))
    with pytest.raises(AgentCrashedError, match="the window is gone"):
        manager.close()
    assert CarlaDataProvider.get_hero_actor() is None


class Theirs:
    """As ScenarioRunner's provider, which finds the hero in a pool and destroys what is left in there."""

    _carla_actor_pool: dict[int, Any] = {}  # noqa: RUF012 - as theirs
    destroyed: list[int] = []  # noqa: RUF012
    ticks = 0

    @staticmethod
    def nothing(*_: Any) -> None:
        return None

    set_client = set_world = register_actor = set_ego_route = nothing

    @staticmethod
    def on_carla_tick() -> None:
        Theirs.ticks += 1

    @staticmethod
    def cleanup() -> None:
        Theirs.destroyed.extend(Theirs._carla_actor_pool)
        Theirs._carla_actor_pool.clear()


def test_scenario_runners_own_provider_is_kept_up_to_date_from_when_it_is_loaded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    manager, world = begun(Told)
    manager.late_sensors()
    module = SimpleNamespace(CarlaDataProvider=Theirs)
    monkeypatch.setitem(sys.modules, "srunner.scenariomanager.carla_data_provider", module)
    manager.tick(SimpleNamespace(tick=0, server_frame=0))
    assert list(Theirs._carla_actor_pool) == [7]
    Theirs._carla_actor_pool[9] = "spawned by the agent"
    world.frame += 1
    manager.tick(SimpleNamespace(tick=1, server_frame=1))
    manager.close()
    assert Theirs.ticks == 2
    assert Theirs.destroyed == [9]  # the vehicle under test is not the agent's to destroy


@pytest.mark.parametrize("seed", range(8))
def test_bad_agents_of_all_kinds_never_end_in_anything_but_a_sentence(seed: int) -> None:
    rng = np.random.default_rng(seed)
    oddities: list[Any] = [None, 3, "text", [], {}, [None], [{}], [{"type": "sensor.x", "id": 1}], object(), b"", 1j]

    def odd(*_: Any) -> Any:
        return oddities[rng.integers(len(oddities))]

    methods = [name for name in ("setup", "sensors", "run_step", "destroy") if rng.random() < 0.6] or ["run_step"]
    agent_class = type("Odd", (Told,), dict.fromkeys(methods, odd))
    failure = ""
    try:
        manager, _ = begun(agent_class)
        manager.late_sensors()
        manager.tick(SimpleNamespace(tick=0, server_frame=0))
        manager.close()
    except (UserError, AgentCrashedError, AgentInvalidControlError) as error:
        failure = str(error)
    assert not failure or "of Odd" in failure
    assert failure or "run_step" not in methods  # none of the oddities is a control
