"""Run by eyes_peers.py in a Python that has MetaDrive: steps its traffic with a lidar, and with a colour camera.

python peer_metadrive.py STEPS [camera]
"""

import statistics
import sys
import time

from metadrive.constants import VERSION
from metadrive.envs.metadrive_env import MetaDriveEnv

SIZE_PX = (800, 600)
LASERS = 240


def main() -> None:
    steps, sees = int(sys.argv[1]), "camera" in sys.argv
    chosen = {"use_render": False, "traffic_density": 0.1, "map": 4, "log_level": 50}
    if sees:
        from metadrive.component.sensors.rgb_camera import RGBCamera  # noqa: PLC0415 - brings in the renderer

        chosen |= {
            "image_observation": True,
            "sensors": {"rgb_camera": (RGBCamera, *SIZE_PX)},
            "vehicle_config": {"image_source": "rgb_camera", "lidar": {"num_lasers": 0}},
        }
    world = MetaDriveEnv(chosen)
    world.reset()
    taken_ms = []
    for _ in range(steps):
        began = time.perf_counter()
        observation, *_ = world.step([0.0, 0.3])
        taken_ms.append(1000.0 * (time.perf_counter() - began))
    seen = observation["image"].shape if sees else f"{LASERS} lasers in a plane, 50 m"
    print(f"MetaDrive {VERSION}|{seen}|{statistics.median(taken_ms):.2f}")
    world.close()


if __name__ == "__main__":
    main()
