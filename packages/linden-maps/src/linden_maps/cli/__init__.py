"""The commands ``linden map``, a plugin of the command line of ``linden``."""
