"""BASU: the benchmark that judges a shuttle's driver, as an ordinary client of any CARLA 0.9.16 server."""

__version__ = "0.1.0"
