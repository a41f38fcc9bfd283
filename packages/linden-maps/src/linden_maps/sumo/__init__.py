"""A SUMO network, a demand and a scenario folder out of an OpenDRIVE map."""

from linden_maps.sumo.folder import Written, write_folder

__all__ = ["Written", "write_folder"]
