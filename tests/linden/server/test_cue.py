"""Claims about the order of a tick and the question of the Traffic Manager before it."""

import time

from fakes.raw_client import RawClient
from linden.server.cue import PATIENCE_S, Cue
from servers import running_server


def _traffic_manager(client: RawClient) -> None:
    settings = client.call("get_episode_settings")
    settings[0], settings[2] = True, [True, 0.05]
    client.call("set_episode_settings", settings)
    assert client.call("add_traffic_manager_running", ["127.0.0.1", 8000])


def test_a_question_behind_a_tick_is_answered_before_it() -> None:
    with running_server() as server, RawClient(server.port) as client:
        _traffic_manager(client)
        tick = client.request("tick_cue")
        question = client.request("get_episode_settings")
        client.socket.sendall(tick + question)
        first, second = client.answer(), client.answer()
    assert first[1] == second[1] + 1


def test_a_tick_goes_ahead_where_nobody_asks() -> None:
    with running_server() as server, RawClient(server.port) as client:
        _traffic_manager(client)
        begun_s = time.monotonic()
        frames = [client.call("tick_cue") for _ in range(3)]
        took_s = time.monotonic() - begun_s
    assert frames == [frames[0], frames[0] + 1, frames[0] + 2]
    assert took_s >= 2 * PATIENCE_S


def test_a_late_question_counts_for_the_step_it_belongs_to() -> None:
    cue = Cue()
    cue.ticked()  # nobody has asked: the tick went ahead
    cue.answered(1.0)
    assert cue.answered_s is None
    cue.answered(2.0)
    assert cue.answered_s == 2.0
