"""Run CARLA's example for Cosmos against a server of ours: record a drive, replay it, and make its videos.

    python scripts/outside/cosmos.py CLIENT PYTHON OUT

CLIENT is the folder ``PythonAPI/examples/nvidia/cosmos/client`` of carla-simulator/carla. PYTHON has carla 0.9.16,
opencv-python-headless, pyyaml, matplotlib and pillow, and ``ffmpeg`` is on the path. OUT is a new folder. The script
starts ``linden serve``, drives for 1.5 s with the recorder on, and starts ``carla_cosmos_gen.py`` with cameras of
320 x 180 pixels for colour, depth, semantic and instance pictures. The exit code is 0 where every video is there.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import carla

VIDEOS = ("rgb", "rgb_masked", "rgb_edges", "depth", "semantic_segmentation", "instance_segmentation")
CAMERA = """- sensor: {name}
  attributes: {{image_size_x: 320, image_size_y: 180, fov: 110}}
  transform: {{location: {{x: 0, y: 0, z: 1.8}}, rotation: {{pitch: 8, yaw: 0, roll: 0}}}}
"""
CLASSES = "canny_classes:\n  - [128, 64, 128]\n  - [50, 234, 157]\n"  # roads and lane markings
LOG, STEPS, STEP_S = "cosmos.log", 30, 0.05


def recorded(port: int) -> int:
    """Record a drive, and return the id of its vehicle."""
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(60.0)
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    client.start_recorder(LOG, True)
    library, start = world.get_blueprint_library(), world.get_map().get_spawn_points()[10]
    vehicle = world.spawn_actor(library.find("vehicle.tesla.model3"), start)
    for _ in range(STEPS):
        vehicle.apply_control(carla.VehicleControl(throttle=0.6))
        world.tick()
    client.stop_recorder()
    settings.synchronous_mode, settings.fixed_delta_seconds = False, None
    world.apply_settings(settings)
    return int(vehicle.id)


def main() -> int:
    """Start the server and CARLA's example; return 1 if the example fails or a video is missing."""
    client, python, out = Path(sys.argv[1]).resolve(), sys.argv[2], Path(sys.argv[3]).resolve()
    out.mkdir(parents=True)
    names = ("rgb", "depth", "semantic_segmentation", "instance_segmentation")
    (out / "cameras.yaml").write_text("".join(CAMERA.format(name=name) for name in names))
    (out / "classes.yaml").write_text(CLASSES)
    linden = Path(sys.executable).with_name("linden")
    command = [str(linden), "serve", "--port", "0", "--recordings", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        ready = next(found for line in server.stdout if (found := re.search(r"rpc port (\d+)", line)))
        try:
            port = int(ready[1])
            options = ["--sensors", f"file:{out}/cameras.yaml", "--class-filter-config", f"{out}/classes.yaml"]
            options += ["-f", LOG, "-o", f"{out}/videos", "-c", str(recorded(port)), "--port", str(port)]
            program = [python, str(client / "carla_cosmos_gen.py"), *options, "--num-post-workers", "1"]
            code = subprocess.run(program, check=False, env=os.environ).returncode
        finally:
            server.terminate()
    missing = [name for name in VIDEOS if not (out / "videos" / f"{name}.mp4").is_file()]
    print(f"carla_cosmos_gen.py ended with {code}; missing: {', '.join(missing) or 'nothing'}")
    return int(bool(code or missing))


if __name__ == "__main__":
    sys.exit(main())
