"""Takes one picture, in a client of its own, so that the next client need not wait for its first.

``first_look.py [PORT]``. The scene is built when somebody looks at a map for the first time, which takes some seconds.
"""

import queue
import sys

import carla


def look(port: int) -> None:
    """Take a picture from above a spawn point, and leave nothing behind."""
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(120.0)
    world = client.get_world()
    place = world.get_map().get_spawn_points()[0]
    place.location.z += 2.0
    camera = world.spawn_actor(world.get_blueprint_library().find("sensor.camera.rgb"), place)
    frames: queue.Queue[int] = queue.Queue()
    camera.listen(lambda image: frames.put(image.frame))
    frames.get(timeout=120.0)
    camera.stop()
    for _ in range(3):
        world.wait_for_tick()
    camera.destroy()


if __name__ == "__main__":
    look(int(sys.argv[1]) if len(sys.argv) > 1 else 2000)
