"""Claims about an episode's world: weathers and towns that are not there are refused in sentences."""

from types import SimpleNamespace

import carla
import pytest

from basu.episode.world import check_towns, towns_of, weather_called
from basu.errors import UserError


def test_a_weather_is_one_of_carlas_presets() -> None:
    assert weather_called("ClearSunset") == carla.WeatherParameters.ClearSunset
    with pytest.raises(UserError, match=r"no weather called 'Frogs'; there are .*ClearNoon.*WetSunset"):
        weather_called("Frogs")


class OneTown:
    uploaded = None

    @property
    def client(self) -> "OneTown":
        return self

    """A client of a simulator with a map of its own and one town."""

    def get_world(self) -> SimpleNamespace:
        return SimpleNamespace(get_map=lambda: SimpleNamespace(name="OpenDriveMap"))

    def get_available_maps(self) -> list[str]:
        return ["Carla/Maps/Linden"]


def test_all_towns_that_are_missing_are_reported_at_once() -> None:
    here = ["Linden", "OpenDriveMap", "Linden"]
    check_towns(towns_of(OneTown(), here), here)
    elsewhere = ["Town13", "Linden", "Town12", "Town13"]
    with pytest.raises(UserError, match=r"routes are in Town12, Town13, which .* it has Linden, OpenDriveMap: name"):
        check_towns(towns_of(OneTown(), elsewhere), elsewhere)


def test_no_map_is_read_where_the_simulator_offers_all_towns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(OneTown, "get_world")
    assert towns_of(OneTown(), ["Linden"]) == {"Linden"}
