"""Claims about what config() may say."""

import pytest

from basu.agents.autonomous_agent import AgentConfig, parse_config
from basu.errors import UserError


def test_nothing_said_is_everything_default() -> None:
    assert parse_config(None, "A") == parse_config({}, "A") == AgentConfig()


def test_the_thesis_sample_says_all_there_is() -> None:
    given = {
        "routes": "data/route_linden.xml",
        "sensors": "config/sensors.json",
        "sumo": "data/sumo//linden",
        "vehicle": "vehicle.tesla.model3",
        "weather": "ClearSunset",
    }
    assert parse_config(given, "ForwardAgent") == AgentConfig(**given)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ([], r"config\(\) of A returned list; it must return a dict"),
        ({"route": "x"}, "the key 'route', which means nothing here; did you mean 'routes'"),
        ({"zzz": "x"}, "it may have routes, sensors, sumo, track, vehicle, weather"),
        ({"weather": 3}, "'weather' is 3; it must be a text"),
        ({"vehicle": ""}, "'vehicle' is ''; it must be a text"),
    ],
)
def test_a_mistake_gets_a_sentence(given: object, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        parse_config(given, "A")
