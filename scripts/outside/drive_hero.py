"""Drives whoever is called hero with CARLA's own BasicAgent, from a client of its own, episode after episode.

ScenarioRunner's examples expect somebody who drives; its manual_control.py needs a camera and a person.
"""

import carla
from agents.navigation.basic_agent import BasicAgent

LEGS, LEG_M = 150, 2.0
"""The destination: 300 m along the lanes, taking the first of several ways."""
TARGET_KMPH = 30.0


def main() -> None:
    """Look for a hero for ever, and drive it."""
    client = carla.Client("127.0.0.1", 2000)
    client.set_timeout(60.0)
    hero, agent = None, None
    while True:
        try:
            world = client.get_world()
            world.wait_for_tick(10.0)
            found = [
                actor for actor in world.get_actors().filter("vehicle.*") if actor.attributes["role_name"] == "hero"
            ]
            if not found:
                continue
            if hero is None or agent is None or found[0].id != hero.id:
                hero, agent = found[0], agent_for(found[0], world.get_map())
            hero.apply_control(agent.run_step())
        except RuntimeError:  # the episode was begun anew, or nobody ticks
            hero = None


def agent_for(hero: carla.Vehicle, town: carla.Map) -> BasicAgent:
    """An agent with a way to go."""
    agent = BasicAgent(hero, target_speed=TARGET_KMPH, map_inst=town)
    waypoint = town.get_waypoint(hero.get_location())
    for _ in range(LEGS):
        following = waypoint.next(LEG_M)
        if not following:
            break
        waypoint = following[0]
    agent.set_destination(waypoint.transform.location)
    return agent


if __name__ == "__main__":
    main()
