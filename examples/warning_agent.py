"""Two vehicles see more than one: this agent warns others of people by radio, and heeds the warnings that it hears.

`basu run examples/warning_agent.py` drives as `behavioral` does. Every 0.2 s it tells where it sees people. A person
that another vehicle tells of counts for a second as if this agent saw it: the person may be hidden from it.

A warning is a text: `DENM 12 ID X Y VX VY`. 12 is the cause "human presence on the road" of ETSI EN 302 637-3. Then
come the person's actor id, its place in m and its velocity in m/s in CARLA's world frame.
"""

from typing import NamedTuple

from basu.agents.builtin.behavioral import BehavioralAgent
from basu.agents.sight import ActorKind, Other

EVERY_TICKS = 4
KEPT_S = 1.0
MOST = 5  # warnings at a time: the nearest people
HEAD = ["DENM", "12"]


class Warned(NamedTuple):
    person_id: int
    x_m: float
    y_m: float
    velocity_x_mps: float
    velocity_y_mps: float

    def at(self, age_s: float) -> Other:
        x_m, y_m = self.x_m + age_s * self.velocity_x_mps, self.y_m + age_s * self.velocity_y_mps
        velocity = (self.velocity_x_mps, self.velocity_y_mps)
        return Other(self.person_id, ActorKind.WALKER, x_m, y_m, 0.0, *velocity, 0.0, 0.25, 0.25)


def read(text: str) -> Warned | None:
    """Return a warning, None where the text is none: a stranger may send anything."""
    words = text.split()
    try:
        person_id, *numbers = words[2:]
        return Warned(int(person_id), *map(float, numbers)) if words[:2] == HEAD else None
    except (TypeError, ValueError):
        return None


def text_of(person: Other) -> str:
    numbers = (person.x_m, person.y_m, person.velocity_x_mps, person.velocity_y_mps)
    return " ".join([*HEAD, str(person.id), *(f"{number:.2f}" for number in numbers)])


class WarningAgent(BehavioralAgent):
    def setup(self):
        super().setup()
        self.warned, self.ticks = {}, 0  # what was heard and when, by the person's id

    def sensors(self):
        return [{"type": "sensor.other.v2x_custom", "id": "WARNINGS", "z": 3.0}]

    def config(self):
        return {"routes": "routes/linden_leap.xml", "vehicle": "vehicle.easymile.ez10"}

    def others(self, snapshot, sensor_data):
        seen = super().others(snapshot, sensor_data)
        now_s = snapshot.timestamp.elapsed_seconds
        if self.ticks % EVERY_TICKS == 0:
            self.warn([other for other in seen if other.kind is ActorKind.WALKER and other.unseen_s == 0.0])
        self.ticks += 1
        self.hear(sensor_data, snapshot.frame, now_s)
        known = {other.id for other in seen}
        return [*seen, *(warned.at(now_s - s) for number, (warned, s) in self.warned.items() if number not in known)]

    def warn(self, people):
        here = self.vehicle.get_transform().location
        people.sort(key=lambda person: (person.x_m - here.x) ** 2 + (person.y_m - here.y) ** 2)
        for person in people[:MOST]:
            self.send("WARNINGS", text_of(person))

    def hear(self, sensor_data, frame, now_s):
        heard_in, event = sensor_data.get("WARNINGS", (0, ()))
        for message in event if heard_in == frame else ():
            warned = read(message.get()["Message"]["Message"])
            if warned is not None:
                self.warned[warned.person_id] = warned, now_s
        self.warned = {number: (warned, s) for number, (warned, s) in self.warned.items() if now_s - s <= KEPT_S}
