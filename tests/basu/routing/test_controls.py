from basu.routing.controls import SAME_LINE_M, _lines
from basu.routing.model import Control, ControlKind


def light(landmark_id: str, s_m: float) -> Control:
    return Control(
        kind=ControlKind.TRAFFIC_LIGHT, landmark_id=landmark_id, s_m=s_m, x_m=0.0, y_m=0.0, z_m=0.0, yaw_rad=0.0
    )


def test_a_reference_behind_a_line_is_no_second_line() -> None:
    line, reference, next_light = light("4", 100.0), light("4", 105.2), light("7", 110.0)
    assert _lines([line, reference, next_light]) == (line, next_light)


def test_a_light_that_is_passed_twice_has_two_lines() -> None:
    first, again = light("4", 100.0), light("4", 100.0 + SAME_LINE_M)
    assert _lines([first, again]) == (first, again)
