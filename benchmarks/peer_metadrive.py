"""Run by sensor_peers.py and gym_steps.py in a Python that has MetaDrive: steps it with a lidar, or a colour camera.

    python peer_metadrive.py STEPS [camera] [alone]

``alone`` leaves its traffic out.

MetaDrive loads its models from its website when it is first used; releases until 0.3.0.1 bring them along.
"""

import statistics
import sys
import time
from importlib.metadata import version

from metadrive.envs.metadrive_env import MetaDriveEnv

SIZE_PX = (800, 600)
LASERS = 240


def camera() -> dict[str, object]:
    """Return what asks for pictures, as the release has it that is installed."""
    try:
        from metadrive.component.sensors.rgb_camera import RGBCamera  # noqa: PLC0415 - from 0.4 on
    except ImportError:
        return {"image_observation": True, "vehicle_config": {"image_source": "rgb_camera", "rgb_camera": SIZE_PX}}
    return {
        "image_observation": True,
        "sensors": {"rgb_camera": (RGBCamera, *SIZE_PX)},
        "vehicle_config": {"image_source": "rgb_camera"},
    }


def main() -> None:
    steps, sees = int(sys.argv[1]), "camera" in sys.argv
    world = MetaDriveEnv(
        {
            "use_render": False,
            "traffic_density": 0.0 if "alone" in sys.argv else 0.1,
            "map": 4,
            "physics_world_step_size": 0.01,
            "decision_repeat": 5,
        }
        | (camera() if sees else {})
    )
    world.reset()
    taken_ms = []
    for _ in range(steps):
        began = time.perf_counter()
        answer = world.step([0.0, 0.3])
        taken_ms.append(1000.0 * (time.perf_counter() - began))
        if True in answer[2:-1]:  # it is over: done, or terminated or truncated
            world.reset()
    seen = f"a picture of {SIZE_PX[0]} x {SIZE_PX[1]}" if sees else f"{LASERS} lasers in one plane, 50 m"
    print(f"MetaDrive {version('metadrive-simulator')}|{seen}|{statistics.median(taken_ms):.2f}", flush=True)
    world.close()


if __name__ == "__main__":
    main()
