"""Tests of ``basu.metrics.score``."""

import json
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.metrics.infraction import DEFAULT_PENALTIES, Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights
from basu.metrics.passengers.felt import PassengerPlace
from basu.metrics.score import driving_score, infraction_score, infractions, score
from basu.metrics.scoring import Scoring, read_scoring_file, scoring_layer, scoring_to_json
from basu.settings.resolve import resolve
from fakes.drives import at, driven, hit, stop_sign, straight_route, traffic_light

Counts = dict[Infraction, int]


@pytest.mark.parametrize(
    ("counts", "path", "driving"),
    [
        pytest.param({}, 0.98, 0.996, id="basic"),
        pytest.param({Infraction.COLLISION_STATIC: 1, Infraction.SPEEDING: 1}, 0.18, 0.452, id="forward"),
        # the thesis rounds 0.8 ** 3 = 0.512 to 0.51 before it goes on, hence 0.604 for 0.6056
        pytest.param({Infraction.SPEEDING: 3}, 0.98, 0.6056, id="human"),
    ],
)
def test_scores_match_table_5_1(counts: Counts, path: float, driving: float) -> None:
    scoring = Scoring()
    assert driving_score(infraction_score(counts, scoring), path, scoring) == pytest.approx(driving, abs=1e-9)


def scoring_in(document: object, source: str) -> Scoring:
    return resolve(Scoring, [scoring_layer(document, source)])


def test_the_human_of_table_5_1_scores_what_is_printed_when_rounded_as_there() -> None:
    rounded = round(infraction_score({Infraction.SPEEDING: 3}, Scoring()), 2)
    assert driving_score(rounded, 0.98, Scoring()) == pytest.approx(0.604)


COLLISIONS = (Infraction.COLLISION_PEDESTRIAN, Infraction.COLLISION_VEHICLE, Infraction.COLLISION_STATIC)


def test_the_behavioral_of_table_5_1_has_its_driving_score_from_the_printed_0_13() -> None:
    assert driving_score(0.13, 0.56, Scoring()) == pytest.approx(0.216)


@pytest.mark.parametrize(("kind", "infraction"), [*zip(COLLISIONS, (0.40, 0.48, 0.52), strict=True)])
def test_no_one_collision_and_one_speeding_give_the_behaviorals_0_13(kind: Infraction, infraction: float) -> None:
    found = infraction_score({kind: 1, Infraction.SPEEDING: 1}, Scoring())
    assert found == pytest.approx(infraction)
    assert round(found, 2) != 0.13


def test_two_slips_would_give_the_behaviorals_0_13() -> None:
    # neither can be told from the table: the complement of the speeding factor taken for the factor itself, or two
    # pedestrians that the table does not count
    assert DEFAULT_PENALTIES[Infraction.COLLISION_STATIC] * (
        1 - DEFAULT_PENALTIES[Infraction.SPEEDING]
    ) == pytest.approx(0.13)
    counts = {Infraction.COLLISION_PEDESTRIAN: 2, Infraction.COLLISION_STATIC: 1, Infraction.SPEEDING: 1}
    assert infraction_score(counts, Scoring()) == pytest.approx(0.13)


def test_as_the_equations_have_it_the_behavioral_of_table_5_1_scores_0_528() -> None:
    infraction = infraction_score({Infraction.COLLISION_STATIC: 1, Infraction.SPEEDING: 1}, Scoring())
    assert driving_score(infraction, 0.56, Scoring()) == pytest.approx(0.528)


def test_a_red_light_that_was_run_costs_what_the_leaderboard_takes() -> None:
    history = driven(at(10.0, 20.1), route=straight_route(controls=(traffic_light(50.0),)))
    history.frames["route_light"] = 0
    assert score(history, Scoring()).infraction == pytest.approx(0.7)


def test_the_tolerance_for_speeding_is_adjustable() -> None:
    history = driven(at(12.5, 16.0))
    assert score(history, Scoring()).infraction == pytest.approx(0.8)
    assert score(history, Scoring(speeding_tolerance_mps=2.0)).infraction == 1.0


@pytest.mark.parametrize("name", ["speeding_tolerance_mps", "route_deviation_m"])
def test_a_negative_tolerance_is_refused(name: str) -> None:
    with pytest.raises(UserError, match=f"{name} is -1.0; it must be 0 or more"):
        Scoring(**{name: -1.0})


def test_path_following_weighs_what_infractions_leave() -> None:
    assert Scoring(infraction_weight=0.7).path_following_weight == 0.3
    with pytest.raises(UserError, match=r"infraction_weight is 1.5; it must be in 0\.\.1"):
        Scoring(infraction_weight=1.5)


@pytest.mark.parametrize("penalty", [-0.1, 1.5])
def test_a_penalty_that_is_no_factor_is_refused(penalty: float) -> None:
    with pytest.raises(UserError, match=r"penalties.speeding is .*; it must be in 0\.\.1"):
        Scoring(penalties={**DEFAULT_PENALTIES, Infraction.SPEEDING: penalty})


def test_an_adjusted_penalty_enters_the_score() -> None:
    history = driven(at(10.0, 20.1), collisions=[hit(50)])
    mild = Scoring(penalties={**DEFAULT_PENALTIES, Infraction.COLLISION_STATIC: 0.9})
    assert score(history, Scoring()).infraction == pytest.approx(0.65)
    assert score(history, mild).infraction == pytest.approx(0.9)


def test_a_clean_drive_to_the_end_scores_one() -> None:
    assert score(driven(at(10.0, 20.1)), Scoring()) == (1.0, 1.0, 1.0)


def test_infractions_come_in_the_order_in_which_they_happened() -> None:
    history = driven(
        at(12.5, 10.0), route=straight_route(limit_mps=11.0, controls=(stop_sign(60.0),)), collisions=[hit(180)]
    )
    kinds = [found.kind for found in infractions(history)]
    assert kinds == [Infraction.SPEEDING, Infraction.STOP_SIGN, Infraction.COLLISION_STATIC]


def test_a_scoring_survives_a_round_trip() -> None:
    scoring = Scoring(
        infraction_weight=0.7,
        route_deviation_m=1.5,
        comfort_weights=ComfortWeights(balance=1.0, service=0.0),
        standing_place=PassengerPlace(1.0, 0.0, 0.25),
        harsh_stop_mps2=2.0,
    )
    assert scoring_in(json.loads(json.dumps(scoring_to_json(scoring))), "here") == scoring


def test_a_file_says_only_what_differs(tmp_path: Path) -> None:
    path = tmp_path / "mild.json"
    path.write_text('{"penalties": {"speeding": 0.9}, "infraction_weight": 0.5}', encoding="utf-8")
    found = resolve(Scoring, [read_scoring_file(path)])
    assert found.penalties == {**Scoring().penalties, Infraction.SPEEDING: 0.9}
    assert (found.infraction_weight, found.path_following_weight) == (0.5, 0.5)


def test_a_scoring_written_before_red_lights_cost_anything_takes_the_usual_factor() -> None:
    old = {"penalties": {"stop_sign": 0.8}, "infraction_weight": 0.8, "path_following_weight": 0.2}
    assert scoring_in(old, "here") == Scoring()


@pytest.mark.parametrize(
    ("document", "sentence"),
    [
        ({"penaltys": {}}, "penaltys means nothing; did you mean 'penalties'"),
        ({"penalties": {"stop_sing": 0.5}}, "penalties has no 'stop_sing'; did you mean 'stop_sign'"),
        ({"comfort_weights": [1]}, r"comfort_weights is \[1\]; it must be an object"),
        ({"comfort_weights": {"tea": 1}}, "comfort_weights has no 'tea'; there are balance, harsh_stops"),
        ({"comfort_weights": {"harsh_stop": 1}}, "comfort_weights has no 'harsh_stop'; did you mean 'harsh_stops'"),
        ({"comfort_weights": {"service": "no"}}, "comfort_weights.service is 'no'; it must be a number"),
        ({"comfort_weights": {"service": -1}}, "the comfort weight of service is -1.0; it must be 0 or more"),
        ({"standing_place": {"forward": 1}}, "standing_place has no 'forward'; did you mean 'forward_m'"),
        ({"standing_place": [1, 2]}, "standing_place.* is .*; it must be complete"),
        ({"harsh_stop_mps2": -1}, "harsh_stop_mps2 is -1 m/s²; it must be 0 or more"),
        ({"penalties": [1]}, r"penalties is \[1\]; it must be an object"),
        ({"penalties": {"speeding": "much"}}, "penalties.speeding is 'much'; it must be a number"),
        ({"penalties": {"speeding": 1.2}}, "penalties.speeding is 1.2; it must be in 0..1"),
        ({"infraction_weight": 0.8, "path_following_weight": 0.3}, "must be non-negative and sum to 1"),
        ({"path_following_weight": 1.5}, "infraction_weight is -0.5; it must be in 0..1"),
        ({"path_following_weight": "0.5"}, "path_following_weight is '0.5'; it must be a number"),
        ({"infraction_weight": True}, "infraction_weight is True; it must be a number"),
        ({"speeding_tolerance_mps": -1}, "speeding_tolerance_mps is -1 m/s; it must be 0 or more"),
        ({"route_deviation_m": 1e999}, "route_deviation_m is inf; it must be a finite number"),
        ([], "a scoring is a JSON object"),
    ],
)
def test_what_is_no_scoring_is_refused_with_a_sentence(document: object, sentence: str) -> None:
    with pytest.raises(UserError, match=f"^the file: .*{sentence}"):
        scoring_in(document, "the file")


def test_the_file_in_the_manual_is_one() -> None:
    text = (Path(__file__).parents[4] / "docs" / "reference" / "metrics.md").read_text(encoding="utf-8")
    found = scoring_in(json.loads(text.split("```json")[1].split("```")[0]), "the manual")
    assert found.penalties[Infraction.RED_LIGHT] == 1.0
    assert found.path_following_weight == pytest.approx(0.3)


def test_a_file_that_is_not_there_or_no_json_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read: No such file"):
        read_scoring_file(tmp_path / "none.json")
    (tmp_path / "bad.json").write_text("{", encoding="utf-8")
    with pytest.raises(UserError, match="is no JSON"):
        read_scoring_file(tmp_path / "bad.json")
