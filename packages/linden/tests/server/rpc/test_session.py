"""Claims about the functions of a session; more of them are made through the official client."""

from contextlib import suppress

import pytest

from fakes.simulation import EMPTY_MAP, FakeFrames, FakeMaps, FakeSimulation
from linden.errors import Refusal
from linden.protocol.values.episode import EpisodeSettings, OpendriveGenerationParameters
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire.stream import StreamTable, token_bytes
from linden.server.rpc import sensors, session
from linden.server.rpc.context import Context
from linden.server.rpc.registry import Long
from linden.server.rpc.warning_log import KINDS


@pytest.fixture
def context() -> Context:
    return Context(
        world=FakeSimulation(),
        maps=FakeMaps(),
        frames=FakeFrames(sensor_bytes=10),
        streams=StreamTable(2001),
        variable_step_s=lambda: 0.04,
    )


def test_a_variable_step_comes_from_the_clock_and_a_fixed_one_does_not(context: Context) -> None:
    session.tick_cue(context)
    context.world.settings = EpisodeSettings(fixed_delta_seconds=0.05)
    session.tick_cue(context)
    assert context.world.steps_s == [0.04, 0.05]


def test_a_frame_is_put_into_the_outbox_of_subscribers_only(context: Context) -> None:
    assert session.tick_cue(context) == 1
    assert context.outbox == []
    context.streams.subscribe(1)
    context.streams.subscribe(2)
    assert session.tick_cue(context) == 2
    assert [stream for stream, _ in context.outbox] == [1, 2]


@pytest.mark.parametrize(("yaw_deg", "told_deg"), [(-180.0, 180.0), (-179.9999999, 180.0), (-179.9, -179.9)])
def test_a_spawn_point_that_looks_west_has_the_yaw_that_its_actor_will_have(
    context: Context, yaw_deg: float, told_deg: float
) -> None:
    context.world.spawn_points = (Transform(Vector3D(), Rotation(0.0, yaw_deg, 0.0)),)
    assert session.get_map_info(context).spawn_points[0].rotation.yaw == told_deg


def test_tokens_name_the_real_streaming_port(context: Context) -> None:
    assert session.get_episode_info(context).token.data == token_bytes(1, 2001)
    assert sensors.get_sensor_token(context, 7).data == token_bytes(7, 2001)


def carry_out(steps: Long[None]) -> None:
    """Let a handler come to its end, its long work done at once."""
    made = None
    with suppress(StopIteration):
        while True:
            made = steps.send(made)()


def test_an_opendrive_text_can_be_loaded_once_it_was_sent(context: Context) -> None:
    with pytest.raises(Refusal, match="not found"):
        carry_out(session.load_new_episode(context, "OpenDriveMap", reset_settings=True, layers=0xFFFF))
    carry_out(session.copy_opendrive_to_file(context, EMPTY_MAP, OpendriveGenerationParameters()))
    carry_out(session.load_new_episode(context, "OpenDriveMap", reset_settings=True, layers=0xFFFF))
    assert (
        session.get_map_info(context).name == "Carla/Maps/Plain"
    )  # answered first: the episode begins with the next call
    context.begin_pending_load()
    assert session.get_map_info(context).name == "Carla/Maps/OpenDriveMap"


def test_a_traffic_manager_port_belongs_to_the_first_client_that_takes_it(context: Context) -> None:
    context.caller = 5
    assert session.add_traffic_manager_running(context, ("10.0.0.1", 8000))
    context.caller = 6
    assert not session.add_traffic_manager_running(context, ("10.0.0.2", 8000))
    session.client_left(context, 6)
    assert session.get_traffic_manager_running(context, 8000) == ("10.0.0.1", 8000)
    session.client_left(context, 5)
    assert not session.is_traffic_manager_running(context, 8000)
    assert not session.destroy_traffic_manager(context, 8000)


@pytest.mark.parametrize("fixed_s", [0.0, -0.05, 10.5])
def test_a_step_must_be_one(context: Context, fixed_s: float) -> None:
    with pytest.raises(Refusal, match="fixed_delta_seconds must be above 0"):
        session.set_episode_settings(context, EpisodeSettings(fixed_delta_seconds=fixed_s))
    assert context.world.settings == EpisodeSettings()


def test_substeps_shorter_than_the_step_are_warned_about(context: Context, caplog: pytest.LogCaptureFixture) -> None:
    session.set_episode_settings(context, EpisodeSettings(fixed_delta_seconds=0.1))
    assert not caplog.text
    session.set_episode_settings(context, EpisodeSettings(fixed_delta_seconds=0.2))
    assert "longer than max_substeps" in caplog.text


@pytest.mark.parametrize("fixed_s", [0.05, None])
def test_a_frame_of_a_million_substeps_is_refused(context: Context, fixed_s: float | None) -> None:
    endless = EpisodeSettings(fixed_delta_seconds=fixed_s, max_substeps=10**6, max_substep_delta_time=1e-6)
    with pytest.raises(Refusal, match="substeps of a frame, and 100 are the most"):
        session.set_episode_settings(context, endless)
    session.set_episode_settings(
        context, EpisodeSettings(fixed_delta_seconds=0.05, max_substeps=100, max_substep_delta_time=0.0005)
    )


def test_without_substepping_their_figures_do_not_matter(context: Context) -> None:
    settings = EpisodeSettings(substepping=False, max_substeps=0, max_substep_delta_time=0.0)
    assert session.set_episode_settings(context, settings) == 0
    assert context.world.settings == settings


def test_a_bug_of_ours_is_logged_however_many_kinds_of_warnings_clients_have_called_forth(
    context: Context, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(KINDS + 1):
        context.warn_once("x" * number)
    context.warn_once("a walker has no wheels")
    assert "a walker has no wheels" not in caplog.messages
    context.log_bug("internal error in tick_cue")
    assert caplog.messages[-1] == "internal error in tick_cue"


def test_a_load_is_answered_before_its_episode_begins(context: Context) -> None:
    context.caller, before = 7, context.world.episode_id
    carry_out(session.copy_opendrive_to_file(context, EMPTY_MAP, OpendriveGenerationParameters()))
    carry_out(session.load_new_episode(context, "OpenDriveMap", reset_settings=True, layers=0xFFFF))
    assert session.get_episode_info(context).id == before
    assert context.pending_load is not None
    assert context.pending_load.client == 7
    context.begin_pending_load()
    assert session.get_episode_info(context).id != before
    context.begin_pending_load()
    assert context.pending_load is None


def test_a_pending_load_begins_where_its_client_leaves(context: Context) -> None:
    context.caller, before = 7, context.world.episode_id
    carry_out(session.copy_opendrive_to_file(context, EMPTY_MAP, OpendriveGenerationParameters()))
    carry_out(session.load_new_episode(context, "OpenDriveMap", reset_settings=True, layers=0xFFFF))
    session.client_left(context, 8)
    assert context.world.episode_id == before
    session.client_left(context, 7)
    assert context.world.episode_id != before
