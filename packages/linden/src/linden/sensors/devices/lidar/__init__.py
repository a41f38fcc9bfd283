"""Lidars: rays in a fan that turns, and what they meet, as points in the sensor's frame."""

from linden.sensors.devices.lidar.sensor import Lidar, SemanticLidar
from linden.sensors.devices.lidar.sweep import SemanticSweep, Sweep

__all__ = ["Lidar", "SemanticLidar", "SemanticSweep", "Sweep"]
