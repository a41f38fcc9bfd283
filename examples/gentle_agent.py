"""An agent of one's own: steers towards a point ahead on the route, at a walking pace, and reads a sensor.

Run it with `basu run examples/gentle_agent.py`. It knows nothing of signs or other traffic: what does it score?
"""

import math

import carla

from basu.agents.autonomous_agent import AutonomousAgent

PACE_MPS = 3.0
LOOK_AHEAD_M = 5.0


class GentleAgent(AutonomousAgent):
    """Pure pursuit of the route's points at a constant pace."""

    def setup(self):
        self.next = 0
        wheels = self.vehicle.get_physics_control().wheels
        self.most_steer_rad = math.radians(max(wheel.max_steer_angle for wheel in wheels))

    def run_step(self, sensor_data):
        _frame, measured = sensor_data["IMU"]
        pose = self.vehicle.get_transform()
        x_m, y_m = self.point_ahead(pose.location)
        bearing_rad = math.atan2(y_m - pose.location.y, x_m - pose.location.x) - math.radians(pose.rotation.yaw)
        curvature = 2.0 * math.sin(bearing_rad) / LOOK_AHEAD_M
        wheelbase_m = 2.8
        control = carla.VehicleControl()
        control.steer = max(-1.0, min(1.0, math.atan(curvature * wheelbase_m) / self.most_steer_rad))
        speed_mps = self.vehicle.get_velocity().length()
        braking_already = measured.accelerometer.x < -1.0
        control.throttle = 0.0 if braking_already else max(0.0, min(0.6, 0.5 * (PACE_MPS - speed_mps)))
        return control

    def point_ahead(self, at):
        """The first point of the route, after the last one chosen, that is far enough away."""
        points = self.route.points_m
        while self.next < len(points) - 1 and math.dist(points[self.next, :2], (at.x, at.y)) < LOOK_AHEAD_M:
            self.next += 1
        return points[self.next, 0], points[self.next, 1]

    def config(self):
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/sensors.json",
            "vehicle": "vehicle.easymile.ez10",
            "weather": "CloudyNoon",
        }
