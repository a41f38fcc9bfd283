"""An agent with eyes: BASU's own driver, with three cameras, a lidar, a radar, GNSS and an IMU on the shuttle.

Run it with `basu run examples/watching_agent.py --routes routes/linden_short.xml`. Every five seconds it keeps what its
cameras see, in the folder `seen`, and says how near the lidar and the radar find something ahead.
"""

import math

import numpy as np

from basu.agents.builtin.basic import BasicAgent

KEEP_EVERY = 100  # steps of 0.05 s
HALF_WIDTH_M = 1.2  # of the lane ahead in which the lidar's points count
FLOOR_M, ROOF_M = -2.4, -0.5  # in the lidar's frame, which is 2.9 m above the road


class WatchingAgent(BasicAgent):
    """Drives as the basic agent does, and looks around."""

    step = 0

    def run_step(self, sensor_data):
        frames = {frame for frame, _ in sensor_data.values()}
        if len(frames) != 1:
            raise RuntimeError(f"the sensors are out of step: {sorted(frames)}")
        if self.step % KEEP_EVERY == 0:
            self.look(*frames, {name: measured for name, (_, measured) in sensor_data.items()})
        self.step += 1
        return super().run_step(sensor_data)

    def look(self, frame, seen):
        for name in ("LEFT", "FRONT", "RIGHT"):
            seen[name].save_to_disk(f"seen/{frame:06d}-{name.lower()}.png")
        x, y, z, _ = np.frombuffer(seen["LIDAR"].raw_data, np.float32).reshape(-1, 4).T
        ahead = x[(x > 2.0) & (np.abs(y) < HALF_WIDTH_M) & (z > FLOOR_M) & (z < ROOF_M)]
        echo = min((echo.depth for echo in seen["RADAR"]), default=math.inf)
        near = min(ahead, default=math.inf)
        print(f"frame {frame}: {len(x)} points; ahead: lidar {near:.1f} m, radar {echo:.1f} m", flush=True)

    def config(self):
        return {**super().config(), "sensors": "config/rig.json"}
