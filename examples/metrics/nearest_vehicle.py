"""How close other vehicles came, and how fast both were then.

basu metrics runs/latest --metric examples/metrics/nearest_vehicle.py --plot nearest.png
"""

import matplotlib.pyplot as plt
import numpy as np

from basu_carla_log.metric_file import BasicMetric

NEAR_M = 100.0  # what is farther away is left out: ScenarioRunner keeps who waits for its cue 500 m below the ground


class NearestVehicle(BasicMetric):
    """From middle to middle, over the frames in which both are there."""

    def _create_metric(self, town_map, log, criteria):
        ego_id = log.get_ego_vehicle_id()
        others = [other for other in log.get_actor_ids_with_type_id("vehicle.*") if other != ego_id]
        if not others:
            print("there is no other vehicle in this recording")
            return
        ego = log.get_actor_arrays(ego_id)
        _, axes = plt.subplots(figsize=(8.0, 3.6), layout="constrained")
        for other in others:
            theirs = log.get_actor_arrays(other)
            _, mine, its = np.intersect1d(ego.frame, theirs.frame, return_indices=True)
            distance_m = np.linalg.norm(ego.location_m[mine] - theirs.location_m[its], axis=1)
            distance_m[distance_m > NEAR_M] = np.nan
            if np.isnan(distance_m).all():
                continue
            nearest = np.nanargmin(distance_m)
            name = f"{log.get_actor_attributes(other)['type_id']} {other}"
            print(
                f"{name}: {distance_m[nearest]:.2f} m at {ego.t_s[mine[nearest]]:.1f} s, "
                f"ego {ego.speed_mps[mine[nearest]]:.1f} m/s, it {theirs.speed_mps[its[nearest]]:.1f} m/s"
            )
            axes.plot(ego.t_s[mine], distance_m, label=name)
        axes.set(xlabel="simulated time [s]", ylabel="distance to ego [m]", title="Other vehicles", ylim=(0, None))
        axes.legend()
        plt.show()
