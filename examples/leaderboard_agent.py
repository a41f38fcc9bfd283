"""An agent for the CARLA leaderboard, as people write them there: it finds its way by GNSS, compass and speedometer.

The leaderboard runs this file as it stands, and so does BASU, with or without the leaderboard installed:
`basu run examples/leaderboard_agent.py --routes routes/linden_short.xml`. It looks at no signs and no people.
"""

import math

import carla
from leaderboard.autoagents.autonomous_agent import AutonomousAgent, Track

PACE_MPS = 5.0
LOOK_AHEAD_M = 6.0
WHEELBASE_M = 2.9
MOST_STEER_RAD = math.radians(70.0)
DEGREE_M = 111_319.49  # of latitude
TRUST = 0.05  # how much of a new fix counts: one alone is half a metre off


def get_entry_point():
    """Tell the leaderboard the name of the class below."""
    return "CompassAgent"


class CompassAgent(AutonomousAgent):
    """Pure pursuit of the plan, from where it believes itself to be."""

    def setup(self, path_to_conf_file):
        self.track = Track.SENSORS
        self.believed = None
        self.next = 0
        self.before_s = 0.0

    def sensors(self):
        level = {"x": 0.0, "y": 0.0, "z": 1.6, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}
        return [
            {"type": "sensor.other.gnss", "id": "GPS", "x": 0.0, "y": 0.0, "z": 1.6},
            {"type": "sensor.other.imu", "id": "IMU", **level},
            {"type": "sensor.speedometer", "id": "SPEED", "reading_frequency": 20},
        ]

    def set_global_plan(self, global_plan_gps, global_plan_world_coord):
        super().set_global_plan(global_plan_gps, global_plan_world_coord)
        self.origin = global_plan_gps[0][0]
        self.plan = [self.metres(place["lat"], place["lon"]) for place, _ in global_plan_gps]

    def run_step(self, input_data, timestamp):
        latitude, longitude, _ = input_data["GPS"][1]
        yaw_rad = input_data["IMU"][1][6] - math.pi / 2  # the compass counts from north, CARLA's yaw from east
        speed_mps = input_data["SPEED"][1]["speed"]
        x_m, y_m = self.where(self.metres(latitude, longitude), yaw_rad, speed_mps, timestamp - self.before_s)
        self.before_s = timestamp
        to_x_m, to_y_m = self.point_ahead(x_m, y_m)
        bearing_rad = math.atan2(to_y_m - y_m, to_x_m - x_m) - yaw_rad
        wheels_rad = math.atan(2.0 * WHEELBASE_M * math.sin(bearing_rad) / LOOK_AHEAD_M)
        missing_mps = PACE_MPS - speed_mps
        return carla.VehicleControl(
            throttle=max(0.0, min(0.6, 0.3 * missing_mps)),
            brake=max(0.0, min(0.5, -0.2 * missing_mps)),
            steer=max(-1.0, min(1.0, wheels_rad / MOST_STEER_RAD)),
        )

    def where(self, fix, yaw_rad, speed_mps, dt_s):
        """Believe the way that was driven since the last step, and a little of the new fix."""
        if self.believed is None:
            self.believed = fix
        ahead_m = speed_mps * dt_s
        x_m, y_m = self.believed[0] + ahead_m * math.cos(yaw_rad), self.believed[1] + ahead_m * math.sin(yaw_rad)
        self.believed = x_m + TRUST * (fix[0] - x_m), y_m + TRUST * (fix[1] - y_m)
        return self.believed

    def point_ahead(self, x_m, y_m):
        """The first point of the plan, after the last one chosen, that is far enough away."""
        while self.next < len(self.plan) - 1 and math.dist(self.plan[self.next], (x_m, y_m)) < LOOK_AHEAD_M:
            self.next += 1
        return self.plan[self.next]

    def metres(self, latitude, longitude):
        """East and south of where the plan begins, near enough for a town."""
        narrower = math.cos(math.radians(self.origin["lat"]))
        return (longitude - self.origin["lon"]) * DEGREE_M * narrower, (self.origin["lat"] - latitude) * DEGREE_M
