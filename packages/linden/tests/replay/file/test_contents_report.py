import struct
import time
from pathlib import Path

import pytest

from fakes import recordings as made
from linden.replay.file.contents_report import file_info
from linden.replay.file.read import Recording
from linden.replay.file.reports import number

NAN, INFINITY = float("nan"), float("inf")


@pytest.fixture(autouse=True)
def utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()


def physics(actor_id: int) -> bytes:
    head = struct.pack("<I5f?4f3f", actor_id, 6500, 1, 0.05, 2, 0.35, True, 10, 3.21, 1696, 0.3, 0.6, 0, -0.3)
    curves = struct.pack("<I4f", 2, 0, 500, 5000, 500), struct.pack("<I4f", 2, 0, 1, 120, 0.7)
    gears = struct.pack("<I3f", 1, 4.584, 0.23, 0.54)
    wheels = struct.pack("<I12f", 1, 3.5, 0.25, 70, 35.5, 800, 0, 3, 20, 3000, 1, 2, 3)
    return head + curves[0] + gears + curves[1] + wheels


def bones(actor_id: int) -> bytes:
    return struct.pack("<IH", actor_id, 1) + made.text("hip") + struct.pack("<6f", 1, 2, 3, 4, 5, 6)


FIRST = made.frame(
    1,
    0.0,
    made.packet(20, struct.pack("<d", 4.5)),
    made.added(
        made.actor(24, "traffic.traffic_light", 3, (9499.25, -7041, 1e-5), (0, 0, 0)),
        made.actor(29, "vehicle.lincoln.mkz_2017", 1, (1234567, 0.1, 0), attributes=[(3, "role_name", "hero")]),
    ),
    made.removed(12, 13),
    made.several(4, "II", [(30, 29)]),
    made.several(5, "IIIBB", [(3, 29, 31, 1, 1), (4, 31, 0xFFFFFFFF, 0, 0)]),
    made.positions((29, 100, 200.5, -0.0, 1, 2, 3)),
    made.several(7, "IBfb", [(24, 1, 1.5, 2)]),
    made.several(8, "IfffBi", [(29, -0.25, 0.5, 1, 0, -1)]),
    made.several(9, "If", [(40, 1.4)]),
    made.several(10, "II", [(29, 0b11), (30, 0), (31, 0b111_1111_1111)]),
    made.several(11, "if4fBB", [(5, 100, 1, 0.5, 0, 1, 1, 2)]),
    made.several(12, "I6f", [(29, 1, 2, 3, 4, 5, 6)]),
    made.several(13, "I6f", [(1, NAN, -NAN, INFINITY, -INFINITY, 0, 1)]),
    made.several(17, "I6f", [(24, 1, 2, 3, 4, 5, 6)]),
    made.packet(14, struct.pack("<d", 12.5)),
    made.packet(15, struct.pack("<H", 1) + physics(29)),
    made.several(16, "Ifff", [(24, 10, 3, 2)]),
    made.packet(19, struct.pack("<H", 1) + bones(40)),
    made.several(21, "IBB", [(29, 0, 1)]),
)
QUIET = made.frame(2, 1 / 60, made.removed(), made.positions((29, 100, 200.5, 0, 1, 2, 3)))
LAST = made.frame(3, 24.716449, made.removed(29), duration_s=-1.0)

TEXT_OF_EVENTS = """Version: 1
Map: Town01
Date: 11/19/21 12:00:00

Frame 1 at 0 seconds
 Create 24: traffic.traffic_light (3) at (9499.25, -7041, 1e-05)
 Create 29: vehicle.lincoln.mkz_2017 (1) at (1.23457e+06, 0.1, 0)
  role_name = hero
 Destroy 12
 Destroy 13
 Collision id 3 between 29 (hero)  with 31
 Collision id 4 between 31 with 4294967295
 Parenting 30 with 29 (parent)
"""
TEXT_OF_STATES = """ Positions: 1
  Id: 29 Location: (100, 200.5, -0) Rotation: (1, 2, 3)
 State traffic lights: 1
  Id: 24 state: 2 frozen: 1 elapsedTime: 1.5
 Vehicle animations: 1
  Id: 29 Steering: -0.25 Throttle: 0.5 Brake: 1 Handbrake: 0 Gear: -1
 Walker animations: 1
  Id: 40 speed: 1.4
 Vehicle light animations: 3
  Id: 29 Position LowBeam
  Id: 30 None
  Id: 31 Position LowBeam HighBeam Brake RightBlinker LeftBlinker Reverse Interior Fog Special1 Special2
 Scene light changes: 1
  Id: 5 enabled: True intensity: 100 RGB_color: (1, 0.5, 0)
 Dynamic actors: 1
  Id: 29 linear_velocity: (1, 2, 3) angular_velocity: (4, 5, 6)
 Actor bounding boxes: 1
  Id: 1 origin: (nan, -nan, inf) extension: (-inf, 0, 1)
 Actor trigger volumes: 1
  Id: 24 origin: (1, 2, 3) extension: (4, 5, 6)
 Current platform time: 12.5
 Physics Control events: 1
  Id: 29
   max_rpm = 6500
   MOI = 1
   damping_rate_full_throttle = 0.05
   damping_rate_zero_throttle_clutch_engaged = 2
   damping_rate_zero_throttle_clutch_disengaged = 0.35
   use_gear_auto_box = true
   gear_switch_time = 0.5
   clutch_strength = 10
   final_ratio = 3.21
   mass = 1696
   drag_coefficient = 0.3
   center_of_mass = (0.6, 0, -0.3)
   torque_curve = (0, 500) (5000, 500)
   steering_curve = (0, 1) (120, 0.7)
   forward_gears:
    gear 0: ratio 4.584 down_ratio 0.23 up_ratio 0.54
   wheels:
    wheel 0: tire_friction 3.5 damping_rate 0.25 max_steer_angle 70 radius 35.5 max_brake_torque 800 \
max_handbrake_torque 0 position (1, 2, 3)
 Traffic Light time events: 1
  Id: 24 green_time: 10 yellow_time: 3 red_time: 2
 Walkers Bones: 1
  Id: 40
     Bone: "hip" relative: Loc(1, 2, 3) Rot(4, 5, 6)
 Vehicle door animations: 1
  Id: 29
  Doors opened:  Front Left 
"""  # noqa: W291 - CARLA leaves a space behind the door
TAIL = """
Frame 3 at 24.7164 seconds
 Destroy 29



Frames: 3
Duration: 24.7164 seconds
"""


def info(path: Path, *, show_all: bool) -> str:
    with Recording(path) as recording:
        return file_info(recording, show_all=show_all)


def test_the_report_uses_carlas_words(tmp_path: Path) -> None:
    path = made.write(tmp_path, made.header(), FIRST, QUIET, LAST)
    quiet = "\nFrame 2 at 0.0166667 seconds\n Positions: 1\n  Id: 29 Location: (100, 200.5, 0) Rotation: (1, 2, 3)\n"
    assert info(path, show_all=True) == TEXT_OF_EVENTS + TEXT_OF_STATES + quiet + TAIL


def test_frames_without_arrivals_and_departures_leave_a_blank_line_where_not_all_is_shown(tmp_path: Path) -> None:
    path = made.write(tmp_path, made.header(), FIRST, QUIET, LAST)
    assert info(path, show_all=False) == TEXT_OF_EVENTS + "\n" + TAIL


def test_no_doors_are_not_told_for_scenariorunner_would_read_no_positions_after_them(tmp_path: Path) -> None:
    frame = made.frame(1, 0.0, made.several(21, "IBB", []), made.positions())
    text = info(made.write(tmp_path, made.header(), frame), show_all=True)
    assert "door" not in text
    assert " Positions: 0\n" in text


def test_a_cut_recording_is_reported_up_to_its_last_whole_frame(tmp_path: Path) -> None:
    text = info(made.write(tmp_path, made.header(), QUIET, LAST[:-1]), show_all=False)
    assert text.endswith("\nFrames: 2\nDuration: 0.0166667 seconds\n")


@pytest.mark.parametrize(
    ("value", "written"),
    [(0.0, "0"), (100.0, "100"), (0.1, "0.1"), (1234567.0, "1.23457e+06"), (1e-05, "1e-05"), (-0.0, "-0"), (NAN, "nan"),
     (-NAN, "-nan"), (-INFINITY, "-inf"), (999999.5, "1e+06"), (123456.5, "123456")],
)  # fmt: skip
def test_numbers_look_as_a_stream_of_cpp_writes_them(value: float, written: str) -> None:
    assert number(value) == written
