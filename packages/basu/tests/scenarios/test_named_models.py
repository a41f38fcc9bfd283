"""Claims about <other_actor> for the classes of BASU: its model is in the world, or it is refused with its line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.scenarios.cases import open_library
from basu.scenarios.playable import Playable
from basu.scenarios.scenario import Scenario
from basu.testing import offline_place

Read = Callable[..., Playable]
EGO = '<ego_vehicle x="520.0" y="128.1" z="247.4" yaw="-176.8"/><destination x="432.1" y="123.3"/>'


@pytest.fixture
def read(tmp_path: Path) -> Read:
    def reader(type_: str, *elements: str) -> Playable:
        path = tmp_path / "mine.xml"
        others = "\n".join(elements)
        path.write_text(
            f'<scenarios><scenario name="mine_1" type="{type_}" town="Linden">{EGO}\n{others}</scenario></scenarios>'
        )
        (playable,) = open_library([path]).choose([str(path)])
        return playable

    return reader


def other(**attributes: str) -> str:
    return f'<other_actor x="1" y="2" yaw="0" {" ".join(f"{k}={v!r}" for k, v in attributes.items())}/>'


def laid(playable: Playable) -> Scenario:
    return playable.scenario(offline_place([(0, 0), (300, 0)]), playable.values)


def models(playable: Playable) -> dict[str, str]:
    return {spec.name: spec.blueprint for spec in playable.cast(laid(playable))}


def test_the_named_model_is_that_of_the_actor_and_the_rest_is_the_class_s(read: Read) -> None:
    plain = models(read("LeadVehicleSwerves"))
    assert list(plain) == ["leader", "standing"]
    first = models(read("LeadVehicleSwerves", other(model="vehicle.audi.tt")))
    assert first == {**plain, "leader": "vehicle.audi.tt"}
    by_role = models(read("LeadVehicleSwerves", other(model="vehicle.audi.tt", rolename="standing")))
    assert by_role == {**plain, "standing": "vehicle.audi.tt"}


def test_elements_without_a_role_go_to_the_actors_that_no_other_element_names(read: Read) -> None:
    named = other(model="vehicle.audi.tt", rolename="leader")
    assert models(read("LeadVehicleSwerves", named, other(model="vehicle.mini.cooper_s"))) == {
        "leader": "vehicle.audi.tt",
        "standing": "vehicle.mini.cooper_s",
    }


def test_an_element_without_a_model_changes_the_colour_alone(read: Read) -> None:
    playable = read("LeadVehicleSwerves", other(color="1,2,3"))
    leader, _ = playable.cast(laid(playable))
    assert leader.blueprint == models(read("LeadVehicleSwerves"))["leader"]
    assert ("color", "1,2,3") in leader.attributes


@pytest.mark.parametrize(
    ("type_", "element", "sentence"),
    [
        ("LeadVehicleSwerves", other(model="walker.pedestrian.0001"), "'leader' of LeadVehicleSwerves is a vehicle"),
        ("LeadVehicleSwerves", other(rolename="child"), "only the actors leader, standing"),
        ("ControlLoss", other(model="vehicle.audi.tt"), "belongs to no actor, since ControlLoss has no actors"),
    ],
)
def test_an_element_that_cannot_be_honoured_is_refused_with_file_and_line(
    read: Read, type_: str, element: str, sentence: str
) -> None:
    playable = read(type_, element)
    with pytest.raises(ScenarioError, match=r"mine\.xml, line 2: <other_actor>") as refused:
        playable.cast(laid(playable))
    assert sentence in str(refused.value)
