"""Claims about the next light of a route: which one counts, and until when."""

from types import SimpleNamespace

import pytest

from basu.managers.route_lights import RouteLights
from basu.records.history.model import NO_LIGHT
from fakes.drives import stop_sign, straight_route, traffic_light

RED, GREEN = 0, 2


class World:
    """Knows two lights by their signals' ids."""

    def get_traffic_light_from_opendrive_id(self, landmark_id: str) -> SimpleNamespace | None:
        state = {"12": RED, "13": GREEN}.get(landmark_id)
        return None if state is None else SimpleNamespace(get_state=lambda: state)


LIGHTS = RouteLights(
    World(),
    straight_route(
        controls=(stop_sign(10.0), traffic_light(50.0, "12"), traffic_light(60.0, "99"), traffic_light(90.0, "13"))
    ),
    2.0,
)


@pytest.mark.parametrize(
    ("s_m", "state"), [(0.0, RED), (52.9, RED), (53.1, GREEN), (93.1, NO_LIGHT)], ids=["ahead", "under", "past", "last"]
)
def test_a_light_counts_until_its_line_is_a_metre_behind_the_rear(s_m: float, state: int) -> None:
    assert LIGHTS.next_state(s_m) == state


def test_a_signal_that_the_simulator_has_no_light_for_is_passed_over() -> None:
    assert LIGHTS.next_state(55.0) == GREEN
