"""The first agent, with a stop at each stop sign: `basu run examples/stopping_agent.py`."""

import first_agent
import numpy as np

from basu.routing import ControlKind

BRAKING_MPS2 = 0.8  # standing passengers feel stronger braking


class StoppingAgent(first_agent.FirstAgent):
    """Stops with the front bumper 1 m before the line of each stop sign."""

    def setup(self):
        super().setup()
        signs = [control.s_m for control in self.route.controls if control.kind is ControlKind.STOP_SIGN]
        half_length_m = self.vehicle.bounding_box.extent.x
        self.stops_m = [s_m - half_length_m - 1.0 for s_m in signs]  # of the vehicle's middle

    def run_step(self, sensor_data):
        control = super().run_step(sensor_data)
        at, speed_mps = self.vehicle.get_transform().location, self.vehicle.get_velocity().length()
        nearest = np.hypot(*(self.route.points_m[:, :2] - (at.x, at.y)).T).argmin()
        left_m = self.stops_m[0] - self.route.s_m[nearest] if self.stops_m else 1000.0
        if left_m < 1.0 and speed_mps < 0.05:
            self.stops_m.pop(0)  # stopped: continue to the next sign
        elif speed_mps > (2.0 * BRAKING_MPS2 * max(left_m - 0.5, 0.0)) ** 0.5:
            control.throttle, control.brake = 0.0, 0.3
        return control
