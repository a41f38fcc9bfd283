"""Checks of an OpenDRIVE map, one family of mistakes a module; each check maps a map to findings."""
