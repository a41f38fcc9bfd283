"""Claims about the record's files: what is written is what is read, byte for byte the same for the same run."""

from pathlib import Path

import numpy as np
import pytest

from basu.errors import UserError
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring
from basu.records.history import FRAME, OTHER, Facts, History, LaneInvasion, Recorder
from basu.records.history.files import FACTS_FILE, HISTORY_FILE, read_history, write_history
from basu.routing import Stop
from fakes.drives import VEHICLE, at, driven, hit, stop_sign, straight_route

STOP = Stop(id="1", name="St. Stephen's", s_m=30.0, x_m=30.0, y_m=2.0, z_m=0.0, yaw_rad=0.1)


def eventful() -> History:
    route = straight_route(controls=(stop_sign(50.0),), stops=(STOP,))
    rng = np.random.default_rng(11)
    speeds_mps = (10.0 + rng.normal(0.0, 1.5, 300)).tolist()
    invasions = (LaneInvasion(tick=7, markings=("Broken/White", "Solid/Yellow")),)
    return driven(
        speeds_mps,
        route=route,
        limit_mps=9.7,
        collisions=[hit(40), hit(41), hit(250, "x", 9)],
        lane_invasions=invasions,
    )


def with_others(history: History) -> History:
    others = np.zeros(3, dtype=OTHER)
    others["tick"], others["id"], others["x_m"] = [0, 0, 12], [4, 9, 4], [1.0, 2.5, 1.0 / 3.0]
    return History(
        facts=history.facts,
        frames=history.frames,
        others=others,
        collisions=history.collisions,
        lane_invasions=history.lane_invasions,
    )


def test_what_is_read_is_what_was_written(tmp_path: Path) -> None:
    written = with_others(eventful())
    write_history(tmp_path, written)
    found = read_history(tmp_path)
    assert found.frames.tobytes() == written.frames.tobytes()
    assert found.others.tobytes() == written.others.tobytes()
    assert found.collisions == written.collisions
    assert found.lane_invasions == written.lane_invasions
    assert found.facts.vehicle == written.facts.vehicle
    assert found.facts.actor_types == written.facts.actor_types
    assert found.facts.route.controls == written.facts.route.controls
    assert found.facts.route.stops == (STOP,)
    for name in ("points_m", "s_m", "yaw_rad", "lane_width_m", "speed_limit_mps", "is_junction", "road_id", "lane_id"):
        assert np.array_equal(getattr(found.facts.route, name), getattr(written.facts.route, name), equal_nan=True)


def test_the_scores_from_the_folder_equal_the_scores_from_the_run(tmp_path: Path) -> None:
    history = eventful()
    write_history(tmp_path, history)
    assert score(read_history(tmp_path), Scoring()) == score(history, Scoring())
    assert infractions(read_history(tmp_path)) == infractions(history)


def test_one_record_gives_one_sequence_of_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        write_history(tmp_path / name, with_others(eventful()))
    for file in (HISTORY_FILE, FACTS_FILE):
        assert (tmp_path / "first" / file).read_bytes() == (tmp_path / "second" / file).read_bytes()


def test_a_run_without_any_event_can_be_read(tmp_path: Path) -> None:
    write_history(tmp_path, driven(at(5.0, 1.0)))
    found = read_history(tmp_path)
    assert (len(found.frames), found.collisions, found.lane_invasions, len(found.others)) == (20, (), (), 0)


def test_an_unposted_limit_survives(tmp_path: Path) -> None:
    write_history(tmp_path, driven(at(5.0, 1.0), route=straight_route(limit_mps=float("nan"))))
    assert np.isnan(read_history(tmp_path).facts.route.speed_limit_mps).all()


def test_a_folder_that_is_no_run_is_refused_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is no run folder that can be scored"):
        read_history(tmp_path)


def test_a_record_cut_short_is_refused_in_a_sentence(tmp_path: Path) -> None:
    write_history(tmp_path, eventful())
    whole = (tmp_path / HISTORY_FILE).read_bytes()
    (tmp_path / HISTORY_FILE).write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UserError, match="this version cannot read"):
        read_history(tmp_path)


@pytest.mark.parametrize(
    ("version", "sentence"),
    [
        (1, "schema version 1, which lacks what the metrics ask for .*drive it again"),
        (99, "schema version 99, and this"),
    ],
)
def test_facts_of_another_version_are_refused_in_a_sentence(tmp_path: Path, version: int, sentence: str) -> None:
    write_history(tmp_path, eventful())
    text = (tmp_path / FACTS_FILE).read_text()
    (tmp_path / FACTS_FILE).write_text(text.replace('"schema_version": 3', f'"schema_version": {version}'))
    with pytest.raises(UserError, match=sentence):
        read_history(tmp_path)


def test_events_are_ordered_whatever_the_order_of_their_arrival() -> None:
    recorder = Recorder()
    for tick in range(10):
        recorder.frame([float(tick)] + [0.0] * (len(FRAME) - 1))
    for tick, other in ((7, 2), (3, 9), (7, 1), (10, 1)):
        recorder.collision(hit(tick, "vehicle.audi.tt", other))
    facts = Facts(step_s=0.05, vehicle=VEHICLE, route=straight_route(), actor_types={}, actor_sizes={})
    found = recorder.history(facts).collisions
    assert [(c.tick, c.other_id) for c in found] == [(3, 9), (7, 1), (7, 2)]  # the one after the last frame is left out
