"""Every contact of the run: when, who with whom, how fast.

basu metrics runs/latest --metric examples/metrics/collisions.py
"""

from basu_carla_log.metric_file import BasicMetric

SCENERY = 0xFFFFFFFF


class Collisions(BasicMetric):
    """Frames of contact with the same other that follow one another are one line."""

    def _create_metric(self, town_map, log, criteria):
        lasting = {}
        for contact in log.get_collisions():
            pair = contact.actor_id, contact.other_id
            last = lasting.get(pair)
            lasting[pair] = contact.frame
            if last is not None and contact.frame <= last + 1:
                continue
            first, second = (self.name(log, actor) for actor in pair)
            speed = log.get_actor_velocity(contact.actor_id, contact.frame)
            fast = "" if speed is None else f" at {speed.length():.1f} m/s"
            print(f"{contact.t_s:8.2f} s  {first} touches {second}{fast}")
        if not lasting:
            print("nobody touched anything")

    @staticmethod
    def name(log, actor):
        """A type and an id."""
        if actor == SCENERY:
            return "scenery"
        known = log.get_actor_attributes(actor)
        return f"{known['type_id']} {actor}" if known else f"actor {actor}"
