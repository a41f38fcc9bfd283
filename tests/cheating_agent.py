"""An agent that cheats in a step of its own choice, as a file."""

from pathlib import Path

BENCHMARK = "0"  # for the fixture ``kills``: the process that drives the agent, whose number an agent cannot know

AGENT = """
import threading, time

class Cheat(AutonomousAgent):
    def setup(self):
        self.steps = 0
        {at_setup}

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps {when}:
            {deed}
        return carla.VehicleControl(throttle=0.3)

    def config(self):
        return {{"vehicle": "vehicle.tesla.model3"}}

    def others(self):
        moving = [a for a in self.world.get_actors() if a.type_id.startswith(("vehicle.", "walker."))]
        return [a for a in moving if a.id != self.vehicle.id]

    {more}
"""


def cheating_agent(
    folder: Path, name: str, *, at_setup: str = "pass", when: str = "> 20", deed: str, more: str = ""
) -> Path:
    """Write an agent with statements for its set-up, and for its steps when their number is ``when``."""
    path = folder / f"{name}.py"
    path.write_text(AGENT.format(at_setup=at_setup, when=when, deed=deed, more=more))
    return path
