"""Two vehicles see more than one: this agent warns others of people by radio, and heeds the warnings that it hears.

`basu run examples/warning_agent.py` drives as `behavioral` does. Every 0.2 s it tells where it sees people. A person
that another vehicle tells of counts for a second as if this agent saw it: the person may be hidden from it. The
texts are those of the built-in agent `cooperative` (`basu.agents.builtin.cooperation.warnings`), so both understand
each other.
"""

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.builtin.cooperation.warnings import WarnedPeople, warnings_of
from basu.agents.builtin.cooperative import heard_texts

EVERY_TICKS = 4


class WarningAgent(BehavioralAgent):
    def setup(self):
        super().setup()
        self.people, self.ticks = WarnedPeople(), 0

    def sensors(self):
        return [{"type": "sensor.other.v2x_custom", "id": "WARNINGS", "z": 3.0}]

    def config(self):
        return {"routes": "routes/linden_leap.xml", "vehicle": "vehicle.easymile.ez10"}

    def others(self, snapshot, sensor_data):
        seen = super().others(snapshot, sensor_data)
        now_s = snapshot.timestamp.elapsed_seconds
        if self.ticks % EVERY_TICKS == 0:
            here = self.vehicle.get_transform().location
            for text in warnings_of(seen, here.x, here.y):
                self.send("WARNINGS", text)
        self.ticks += 1
        heard = heard_texts(sensor_data, "WARNINGS", snapshot.frame)
        self.people.hear([text for _, text in heard], now_s)
        return [*seen, *self.people.unseen({other.id for other in seen}, now_s)]
