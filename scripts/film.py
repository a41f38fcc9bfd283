"""A sheet of pictures of a recorded drive, from a camera that stands still above the road.

    python scripts/film.py RUN --at 34 --every 1.5 --pictures 6 --output film.jpg

RUN is the folder of a `basu run ... --record` at a simulator of its own. The camera looks along the way of the vehicle
under test, from behind the place of the vehicle in the middle picture. With `--left` it stands so far left of that way
and looks at the road 8 m ahead of the vehicle. Each picture bears the s of the recording.
"""

from __future__ import annotations

import argparse
import queue
from pathlib import Path
from typing import NamedTuple

import carla
import numpy as np
from PIL import Image, ImageDraw

from basu.episode.world import ticked_by_us
from basu.simulator import OwnServer, connect

STEP_S = 0.05
SIZE = 800, 450
COLUMNS = 3
AHEAD_M = 8.0  # from the vehicle to the place on the road at which the camera looks
ROLES = ("hero", "ego", "ego_vehicle")


class View(NamedTuple):
    """Where the camera stands, seen from the vehicle, and how wide it sees; m and degrees."""

    back_m: float
    left_m: float
    up_m: float
    fov_deg: float


def ego_pose(world: carla.World) -> carla.Transform:
    """The pose of the vehicle under test in a replay."""
    (ego,) = [actor for actor in world.get_actors().filter("vehicle.*") if actor.attributes.get("role_name") in ROLES]
    return ego.get_transform()


def clear(client: carla.Client, world: carla.World) -> None:
    """Take the actors of a replay away: the next one spawns its own where their recorded ids are taken."""
    client.stop_replayer(keep_actors=True)
    actors = [actor for actor in world.get_actors() if actor.type_id.startswith(("vehicle.", "walker."))]
    client.apply_batch_sync([carla.command.DestroyActor(actor.id) for actor in actors], True)


def show(client: carla.Client, world: carla.World, log: Path, time_s: float) -> None:
    """Let the world be as it was at a time of the recording."""
    client.replay_file(str(log), time_s, 0.0, 0)
    world.tick()
    world.tick()


def pictures(log: Path, times_s: list[float], view: View) -> list[Image.Image]:
    """One picture for each time, in s from the beginning of the recording."""
    server = OwnServer(recordings=log.parent)
    try:
        client = connect("127.0.0.1", server.port, 600.0)
        world = client.get_world()
        with ticked_by_us(world, STEP_S):
            show(client, world, log, times_s[len(times_s) // 2])
            at = ego_pose(world)
            found = []
            for time_s in times_s:
                clear(client, world)
                show(client, world, log, time_s)
                found.append(taken(world, behind(at, view), view.fov_deg))
                ImageDraw.Draw(found[-1]).text((8, 6), f"{time_s:.1f} s", fill="white", font_size=22)
        return found
    finally:
        server.end()


def behind(pose: carla.Transform, view: View) -> carla.Transform:
    """The pose of a camera behind, left of and above a vehicle, which looks at the road ahead of the vehicle."""
    back_m, left_m, up_m, _ = view
    ahead, right = pose.get_forward_vector(), pose.get_right_vector()
    at = pose.location + carla.Location(
        -back_m * ahead.x - left_m * right.x, -back_m * ahead.y - left_m * right.y, up_m
    )
    way_m = back_m + AHEAD_M
    turn_deg = float(np.degrees(np.arctan2(left_m, way_m))) if left_m else 0.0
    pitch_deg = -float(np.degrees(np.arctan2(up_m, np.hypot(way_m, left_m) if left_m else way_m)))
    return carla.Transform(at, carla.Rotation(pitch_deg, pose.rotation.yaw + turn_deg, 0.0))


def taken(world: carla.World, look: carla.Transform, fov_deg: float) -> Image.Image:
    """The picture of a camera in the next frame."""
    blueprint = world.get_blueprint_library().find("sensor.camera.rgb")
    for name, value in zip(("image_size_x", "image_size_y"), SIZE, strict=True):
        blueprint.set_attribute(name, str(value))
    blueprint.set_attribute("fov", str(fov_deg))
    camera = world.spawn_actor(blueprint, look)
    images: queue.Queue[carla.Image] = queue.Queue()
    camera.listen(images.put)
    world.tick()
    image = images.get(timeout=120.0)
    camera.destroy()
    pixels = np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, 4)
    return Image.fromarray(np.ascontiguousarray(pixels[..., 2::-1]))


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--at", type=float, required=True, metavar="S")
    parser.add_argument("--every", type=float, default=1.0, metavar="S")
    parser.add_argument("--pictures", type=int, default=6)
    parser.add_argument("--back", type=float, default=16.0, metavar="M")
    parser.add_argument("--left", type=float, default=0.0, metavar="M")
    parser.add_argument("--up", type=float, default=7.0, metavar="M")
    parser.add_argument("--fov", type=float, default=90.0, metavar="DEG")
    parser.add_argument("--output", type=Path, required=True)
    arguments = parser.parse_args()
    times_s = [arguments.at + nth * arguments.every for nth in range(arguments.pictures)]
    view = View(arguments.back, arguments.left, arguments.up, arguments.fov)
    found = pictures((arguments.run / "recording.log").resolve(), times_s, view)
    rows = -(-len(found) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SIZE[0], rows * SIZE[1]))
    for nth, picture in enumerate(found):
        sheet.paste(picture, (nth % COLUMNS * SIZE[0], nth // COLUMNS * SIZE[1]))
    sheet.resize((sheet.width // 2, sheet.height // 2), Image.Resampling.LANCZOS).save(arguments.output, quality=85)


if __name__ == "__main__":
    main()
