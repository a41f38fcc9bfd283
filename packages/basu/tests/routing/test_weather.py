"""Claims about the weather of a route: both spellings, what lies between two marks, a sentence for every mistake."""

from pathlib import Path

import carla
import pytest

from basu.errors import UserError
from basu.routing.route_file import read_routes
from basu.routing.weather import UNSAID, WEATHER_FIELDS, WeatherMark, weather_at

POINTS = '<waypoints><position x="0" y="0"/><position x="9" y="0"/></waypoints>'


def marks_of(folder: Path, weather: str) -> tuple[WeatherMark, ...]:
    path = folder / "route.xml"
    path.write_text(f'<routes><route id="3" town="Town01">{weather}{POINTS}</route></routes>')
    (route,) = read_routes(path)
    return route.weather


def test_the_fields_are_those_of_the_client() -> None:
    theirs = carla.WeatherParameters()
    assert set(WEATHER_FIELDS) == {
        name for name, value in vars(carla.WeatherParameters).items() if isinstance(value, property)
    }
    for name in WEATHER_FIELDS:
        if name not in ("cloudiness", "sun_altitude_angle"):
            assert getattr(theirs, name) == pytest.approx(UNSAID.get(name, 0.0))


def test_a_route_without_weather_leaves_it_to_others(tmp_path: Path) -> None:
    assert marks_of(tmp_path, "") == ()
    assert marks_of(tmp_path, "<weathers/>") == ()


def test_the_first_leaderboards_single_weather_holds_all_the_way(tmp_path: Path) -> None:
    marks = marks_of(tmp_path, '<weather id="Rain" precipitation="60" cloudiness="80"/>')
    for percent in (0.0, 50.0, 100.0):
        weather = weather_at(marks, percent)
        assert (weather["precipitation"], weather["cloudiness"], weather["sun_altitude_angle"]) == (60.0, 80.0, 70.0)


def test_between_two_marks_weather_changes_in_proportion(tmp_path: Path) -> None:
    marks = marks_of(
        tmp_path,
        '<weathers><weather route_percentage="80" sun_altitude_angle="10"/>'
        '<weather route_percentage="40" sun_altitude_angle="90"/></weathers>',
    )
    heights = [weather_at(marks, percent)["sun_altitude_angle"] for percent in (0.0, 40.0, 50.0, 80.0, 100.0)]
    assert heights == pytest.approx([90.0, 90.0, 70.0, 10.0, 10.0])


@pytest.mark.parametrize(
    ("weather", "sentence"),
    [
        ('<weather cloudyness="3"/>', "line 1: <weather> has the attribute 'cloudyness'.* did you mean 'cloudiness'?"),
        ('<weather cloudiness="grey"/>', "<weather> has cloudiness='grey', which is no number"),
        ('<weather route_percentage="140"/>', "route_percentage 140; it must be within 0 and 100"),
        ("<weathers><weather/><weather/></weathers>", "route '3' has two weathers at route_percentage 0"),
    ],
)
def test_a_mistake_gets_a_sentence(tmp_path: Path, weather: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        marks_of(tmp_path, weather)
