"""Whole runs that policies of AlpaSim's protocol drive over real gRPC, and what becomes of policies that fail."""

import contextlib
import json
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import carla
import pytest
from carla_driver_interface.driver import DriveContext, DriveResult, SessionState
from carla_driver_interface.policies import ConstantSpeedPolicy, RouteFollowerPolicy
from carla_driver_interface.server import serving

from basu.agents.builtin.perception import OTHERS_TOP_MPS
from basu.agents.builtin.scene import VehicleGeometry
from basu.agents.loader import load_agent
from basu.errors import UserError
from basu.routing import plan
from basu.routing.route_file import read_routes
from basu_alpasim.agent import EgodriverAgent
from basu_alpasim.basic_policy import BasicPolicy, Known
from basu_alpasim.policy_client import PolicyClient
from basu_fixtures import SHORT_ROUTE
from fakes.egodriver_policies import SPOILS, FailingServicer, OtherRevision, OtherVersion, Refusing, served
from ros_runs import has_failed, has_followed_the_route, run
from servers import RunningServer

MAP = Path(__file__).parents[2] / "linden" / "src" / "linden" / "data" / "Linden.xodr"


@pytest.fixture(autouse=True)
def sensors(monkeypatch: pytest.MonkeyPatch) -> None:
    """No camera, which would take most of a run's time."""
    monkeypatch.setattr(EgodriverAgent, "config", lambda _self: {"vehicle": "vehicle.tesla.model3"})


@pytest.fixture
def at(simulator: RunningServer, route_file: Path, tmp_path: Path) -> Any:
    """Runs a policy at an address: the exit code, the result and the run's folder."""

    def drive(address: str, *options: str) -> tuple[int, Mapping[str, Any], Path]:
        return run(f"egodriver:{address}", simulator, route_file, tmp_path, *options)

    return drive


class Listening(RouteFollowerPolicy):
    """The reference policy, which keeps what it was sent."""

    def __init__(self) -> None:
        super().__init__(cruise_speed_mps=5.0)
        self.seen: list[DriveContext] = []
        self.poses: list[int] = []
        self.sessions: list[str] = []

    def on_session_start(self, session: SessionState) -> None:
        self.sessions.append("start")

    def on_session_close(self, session: SessionState) -> None:
        self.poses = session.ego_trajectory.timestamps_us
        self.sessions.append("close")

    def drive(self, ctx: DriveContext) -> DriveResult:
        self.seen.append(ctx)
        return super().drive(ctx)


def test_the_reference_policy_drives_along_the_route_as_it_comes(at: Any) -> None:
    policy = Listening()
    with serving(policy, port=0, host="127.0.0.1") as port:
        _, result, folder = at(f"127.0.0.1:{port}", "--stop-after", "6")
    has_followed_the_route(result, folder)
    assert policy.sessions == ["start", "close"]
    assert [ctx.time_now_us for ctx in policy.seen] == list(range(0, 6_000_001, 100_000))
    assert {ctx.time_query_us - ctx.time_now_us for ctx in policy.seen} == {100_000}
    assert policy.poses == list(range(0, 6_000_001, 50_000))
    data = policy.seen[-1].renderer_data
    assert data is not None
    assert data.speed_limit_mps > 0.0


def test_basic_behind_the_protocol_keeps_to_the_route(at: Any) -> None:
    command = [
        str(Path(sys.executable).with_name("basu")),
        "serve",
        "egodriver",
        "basic",
        "--port",
        "0",
        "--cruise",
        "5",
    ]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().split(" at ")[1].split(";")[0]
            _, result, folder = at(address, "--stop-after", "6")
            has_followed_the_route(result, folder)
        finally:
            process.terminate()
        assert process.wait(timeout=20) == 0


@pytest.mark.parametrize(
    ("kind", "status", "says"),
    [
        ("nan", "AgentInvalidControl", "answered drive at 0.20 s with y = nan in pose 3"),
        ("empty", "AgentInvalidControl", "answered drive at 0.20 s with an empty trajectory"),
        ("stale", "AgentInvalidControl", "answered drive at 0.20 s with a trajectory that ends at 0.00 s"),
        (
            "flooding",
            "AgentInvalidControl",
            "answered drive at 0.20 s with a trajectory of 100041 poses; at most 10000",
        ),
        ("late", "AgentTimedOut", "did not answer drive at 0.20 s within the limit"),
        ("raising", "AgentCrashed", "refused drive at 0.20 s: UNKNOWN: Exception calling application: no weights"),
        ("ending", "AgentCrashed", "ended the session with its answer to drive at 0.20 s"),
    ],
)
def test_a_policy_that_fails_is_the_agent_s_failure_and_the_record_is_kept(
    at: Any, kind: str, status: str, says: str
) -> None:
    with served(FailingServicer(SPOILS[kind])) as address:
        has_failed(at(address, "--step-limit", "3"), status, says)


def test_a_policy_that_dies_on_the_way_is_the_agent_s_failure(at: Any) -> None:
    with contextlib.ExitStack() as stack:

        def end(_response: Any) -> None:
            threading.Thread(target=stack.close).start()
            threading.Event().wait(10.0)  # the answer that never comes

        address = stack.enter_context(served(FailingServicer(end)))
        ended = at(address, "--step-limit", "8")
    has_failed(ended, "AgentCrashed", "drive at 0.20 s")


@pytest.mark.parametrize(
    ("servicer", "says"),
    [
        (OtherVersion(ConstantSpeedPolicy()), "answers get_version with version 1.2.0 of AlpaSim's protocol"),
        (OtherRevision(ConstantSpeedPolicy()), "contract revision 9 is not one of"),
        (Refusing(ConstantSpeedPolicy()), "refused start_session at 0.00 s: FAILED_PRECONDITION: no camera_front"),
        (None, "does not know the call get_version at 0.00 s: it is no policy"),
    ],
    ids=["version", "revision", "refusal", "no policy"],
)
def test_a_policy_that_cannot_begin_is_the_agent_s_failure(at: Any, servicer: Any, says: str) -> None:
    with served(servicer) as address:
        code, result, _ = at(address)
    assert (code, result["status"], result["fault"]) == (1, "AgentCrashed", "agent"), result["message"]
    assert says in result["message"]


def test_an_address_without_a_policy_is_a_time_out(at: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(EgodriverAgent, "appears_s", 0.5)
    _, result, _ = at("127.0.0.1:1")
    assert (result["status"], result["fault"]) == ("AgentTimedOut", "agent")
    assert "no policy answers at 127.0.0.1:1 within 0.5 s of wall time; start it" in result["message"]


@pytest.mark.parametrize(
    ("wanted", "address", "name"),
    [
        ("egodriver", "127.0.0.1:50051", "egodriver"),
        ("egodriver:policies:7", "policies:7", "egodriver-policies-7"),
        ("egodriver:unix:///run/policy.sock", "unix:///run/policy.sock", "egodriver-unix-run-policy.sock"),
    ],
)
def test_the_address_stands_behind_the_name(wanted: str, address: str, name: str) -> None:
    loaded = load_agent(wanted)
    assert issubclass(loaded.agent_class, EgodriverAgent)
    assert (loaded.agent_class.address, loaded.name) == (address, name)


@pytest.mark.slow
def test_basic_behind_the_protocol_drives_as_well_as_basic_itself(simulator: RunningServer, tmp_path: Path) -> None:
    description = read_routes(SHORT_ROUTE)[0]
    route = plan(carla.Map("Linden", MAP.read_text("utf-8")), description)
    body = VehicleGeometry(wheelbase_m=2.87, rear_axle_m=1.44, front_m=2.4, rear_m=2.4, half_width_m=1.08)
    policy = BasicPolicy(Known(body, route, OTHERS_TOP_MPS))
    with serving(policy, port=0, host="127.0.0.1") as port:
        _, behind, _ = run(f"egodriver:127.0.0.1:{port}", simulator, SHORT_ROUTE, tmp_path / "behind")
    model3 = ("--vehicle", "vehicle.tesla.model3")
    _, itself, _ = run("basic", simulator, SHORT_ROUTE, tmp_path / "itself", *model3)
    assert behind["passed"], behind["reasons"]
    assert behind["scores"]["driving"] == pytest.approx(itself["scores"]["driving"], abs=0.002)
    assert behind["meta"]["simulated_s"] == pytest.approx(itself["meta"]["simulated_s"], abs=1.0)


@pytest.mark.parametrize("address", ["localhost", "localhost:", "nonsense:port"])
def test_what_is_no_address_is_said_so(address: str) -> None:
    with pytest.raises(UserError, match=f"'{address}' is no address of a policy"):
        PolicyClient(address)


def test_a_camera_s_pictures_arrive_with_the_time_of_their_frame(
    at: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    camera = {"type": "sensor.camera.rgb", "id": "front", "x": 1.0, "z": 1.5, "width": 64, "height": 48, "fov": 90}
    file = tmp_path / "sensors.json"
    file.write_text(json.dumps([camera]))
    wishes = {"vehicle": "vehicle.tesla.model3", "sensors": str(file)}
    monkeypatch.setattr(EgodriverAgent, "config", lambda _self: wishes)
    pictures: list[tuple[int, tuple[int, ...]]] = []

    class Looking(ConstantSpeedPolicy):
        def drive(self, ctx: DriveContext) -> DriveResult:
            frame = ctx.session.latest_frame("front")
            if frame is not None:
                pictures.append((ctx.time_now_us - frame.timestamp_us, frame.as_array().shape))
            return super().drive(ctx)

    with serving(Looking(), port=0, host="127.0.0.1") as port:
        _, result, _ = at(f"127.0.0.1:{port}", "--stop-after", "1")
    assert result["status"] == "Stopped", result["message"]
    assert len(pictures) >= 10
    assert set(pictures) == {(0, (48, 64, 3))}
