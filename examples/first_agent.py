"""A first agent in 15 lines: it follows the route to its end. Run it with `basu run examples/first_agent.py`."""

import math

import carla
import numpy as np

from basu.agents.autonomous_agent import AutonomousAgent


class FirstAgent(AutonomousAgent):
    def setup(self):
        self.most_steer_rad = math.radians(self.vehicle.get_physics_control().wheels[0].max_steer_angle)

    def run_step(self, sensor_data):  # every 0.05 s of simulated time
        pose, speed_mps = self.vehicle.get_transform(), self.vehicle.get_velocity().length()
        points = self.route.points_m[:, :2]  # about one a metre
        nearest = np.hypot(*(points - (pose.location.x, pose.location.y)).T).argmin()
        x_m, y_m = points[min(nearest + 5, len(points) - 1)]  # 5 m ahead
        bearing_rad = math.atan2(y_m - pose.location.y, x_m - pose.location.x) - math.radians(pose.rotation.yaw)
        steer = math.atan(2.0 * math.sin(bearing_rad) * 2.8 / 5.0) / self.most_steer_rad  # pure pursuit, wheelbase 2.8
        throttle = 0.5 * (4.0 - speed_mps)  # 4 m/s; stop signs are scored, and this agent passes them
        return carla.VehicleControl(throttle=min(max(throttle, 0.0), 0.6), steer=min(max(steer, -1.0), 1.0))

    def config(self):
        return {"routes": "routes/linden_short.xml", "vehicle": "vehicle.easymile.ez10"}
