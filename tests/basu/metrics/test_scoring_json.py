"""Claims about scorings as files: what may be left out, what is refused and how."""

import json
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.metrics.infraction import Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights
from basu.metrics.passengers.felt import Place
from basu.metrics.score import Scoring
from basu.metrics.scoring_json import read_scoring_file, scoring_from_json, scoring_to_json
from basu.settings.resolve import resolve


def test_a_scoring_survives_a_round_trip() -> None:
    scoring = Scoring(
        infraction_weight=0.7,
        route_deviation_m=1.5,
        comfort_weights=ComfortWeights(balance=1.0, service=0.0),
        standing_place=Place(1.0, 0.0, 0.25),
        harsh_stop_mps2=2.0,
    )
    assert scoring_from_json(json.loads(json.dumps(scoring_to_json(scoring))), "here") == scoring


def test_a_file_says_only_what_differs(tmp_path: Path) -> None:
    path = tmp_path / "mild.json"
    path.write_text('{"penalties": {"speeding": 0.9}, "infraction_weight": 0.5}', encoding="utf-8")
    found = resolve(Scoring, [read_scoring_file(path)])
    assert found.penalties == {**Scoring().penalties, Infraction.SPEEDING: 0.9}
    assert (found.infraction_weight, found.path_following_weight) == (0.5, 0.5)


def test_a_scoring_written_before_red_lights_cost_anything_takes_the_usual_factor() -> None:
    old = {"penalties": {"stop_sign": 0.8}, "infraction_weight": 0.8, "path_following_weight": 0.2}
    assert scoring_from_json(old, "here") == Scoring()


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
        scoring_from_json(document, "the file")


def test_the_file_in_the_manual_is_one() -> None:
    text = (Path(__file__).parents[3] / "docs" / "reference" / "metrics.md").read_text(encoding="utf-8")
    found = scoring_from_json(json.loads(text.split("```json")[1].split("```")[0]), "the manual")
    assert found.penalties[Infraction.RED_LIGHT] == 1.0
    assert found.path_following_weight == pytest.approx(0.3)


def test_a_file_that_is_not_there_or_no_json_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read: No such file"):
        read_scoring_file(tmp_path / "none.json")
    (tmp_path / "bad.json").write_text("{", encoding="utf-8")
    with pytest.raises(UserError, match="is no JSON"):
        read_scoring_file(tmp_path / "bad.json")
