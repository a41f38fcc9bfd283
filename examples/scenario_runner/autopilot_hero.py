"""Lets CARLA's autopilot drive ScenarioRunner's hero, in step with it.

``python autopilot_hero.py [--port 2000] [--tm-port 8000] [--way Left Straight]``, before or after ScenarioRunner is
started. Its ``--scenario`` takes no agent: somebody else has to drive. A client of its own reacts whenever its turn
comes; the Traffic Manager inside ScenarioRunner answers every frame, so it is asked to drive the hero as well.
"""

from __future__ import annotations

import argparse
import time

import carla

LOOK_EVERY_S = 0.1


def main() -> None:
    """Wait for a hero, hand it to ScenarioRunner's Traffic Manager, and stay until it is gone."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=2000)
    parser.add_argument("--tm-port", type=int, default=8000, help="ScenarioRunner's --trafficManagerPort")
    parser.add_argument("--way", nargs="*", default=[], choices=("Left", "Right", "Straight"), help="at each junction")
    args = parser.parse_args()
    client = carla.Client(args.host, args.port)
    client.set_timeout(60.0)
    while (hero := hero_in(client.get_world())) is None:
        time.sleep(LOOK_EVERY_S)
    manager = client.get_trafficmanager(args.tm_port)  # there already: ScenarioRunner makes it before the hero
    hero.set_autopilot(True, args.tm_port)
    if args.way:
        manager.set_route(hero, args.way)
    print(f"the autopilot drives {hero.type_id}", flush=True)
    while client.get_world().get_actor(hero.id) is not None:
        time.sleep(1.0)


def hero_in(world: carla.World) -> carla.Vehicle | None:
    """The vehicle whose role is hero, if it is there."""
    vehicles = world.get_actors().filter("vehicle.*")
    return next((vehicle for vehicle in vehicles if vehicle.attributes["role_name"] == "hero"), None)


if __name__ == "__main__":
    main()
