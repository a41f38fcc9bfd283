"""Radios: the messages of stations, the loss of power on the way, and what is between two antennas."""
