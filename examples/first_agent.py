"""A first agent: follows the route at 4 m/s. It ignores signs and other actors: `basu run examples/first_agent.py`."""

import math

import carla

from basu.agents.autonomous_agent import AutonomousAgent


class FirstAgent(AutonomousAgent):
    """Steers at the point of the route that is 5 m ahead."""

    def setup(self):
        self.next = 0  # index of the route's point to steer at
        self.most_steer_rad = math.radians(self.vehicle.get_physics_control().wheels[0].max_steer_angle)

    def run_step(self, sensor_data):
        pose, points = self.vehicle.get_transform(), self.route.points_m
        x, y = pose.location.x, pose.location.y
        while self.next < len(points) - 1 and math.dist(points[self.next, :2], (x, y)) < 5.0:
            self.next += 1
        bearing_rad = math.atan2(points[self.next, 1] - y, points[self.next, 0] - x) - math.radians(pose.rotation.yaw)
        steer = math.atan(2.8 * 2.0 * math.sin(bearing_rad) / 5.0) / self.most_steer_rad  # 2.8 m between the axles
        throttle = 0.5 * (4.0 - self.vehicle.get_velocity().length())
        return carla.VehicleControl(throttle=min(max(throttle, 0.0), 0.6), steer=min(max(steer, -1.0), 1.0))

    def config(self):
        return {"routes": "routes/linden_short.xml", "sensors": "config/sensors.json"}
