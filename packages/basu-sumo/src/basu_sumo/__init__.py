"""SUMO in step with CARLA: the link to SUMO, vehicles and lights both ways; of use to any script of CARLA's client."""

from basu_sumo.bridge import Bridge
from basu_sumo.link import Link, connected, in_process

__all__ = ["Bridge", "Link", "connected", "in_process"]
