"""How far the vehicle under test is from the middle of its lane, over the run: figure 5.1 of the thesis.

basu metrics runs/latest --metric examples/metrics/distance_to_lane_center.py --plot lane.png
"""

import matplotlib.pyplot as plt
import numpy as np

from basu_carla_log.metric_file import BasicMetric


class DistanceToLaneCenter(BasicMetric):
    """The middle of the vehicle against that of the nearest driving lane; to the right is positive."""

    def _create_metric(self, town_map, log, criteria):
        ego = log.get_actor_arrays(log.get_ego_vehicle_id())
        offset_m = np.array([self.offset_m(town_map, log, frame) for frame in ego.frame])
        worst = np.abs(offset_m).argmax()
        print(f"{len(offset_m)} frames, {ego.t_s[-1] - ego.t_s[0]:.1f} s")
        print(f"r.m.s. distance   {np.sqrt(np.mean(offset_m**2)):.3f} m")
        print(f"largest distance  {abs(offset_m[worst]):.3f} m, at {ego.t_s[worst]:.1f} s")
        self.draw(ego.t_s, offset_m)

    @staticmethod
    def offset_m(town_map, log, frame):
        """Right of the lane's middle in one frame, by the map's own lane."""
        place = log.get_actor_transform("hero", int(frame)).location
        lane = town_map.get_waypoint(place).transform
        return (place - lane.location).dot(lane.get_right_vector())

    @staticmethod
    def draw(t_s, offset_m):
        """Distance over time."""
        _, axes = plt.subplots(figsize=(8.0, 3.6), layout="constrained")
        axes.axhline(0.0, color="0.6", linewidth=0.8)
        axes.plot(t_s, offset_m, color="#1f5fa8", linewidth=1.4)
        axes.set(xlabel="simulated time [s]", ylabel="distance to lane centre [m]\nright of it is positive")
        axes.set_title("Distance to the lane's centre")
        axes.margins(x=0.01)
        axes.grid(alpha=0.3)
        plt.show()
