"""CARLA's recordings: their bytes and their reports. Knows no simulation."""
