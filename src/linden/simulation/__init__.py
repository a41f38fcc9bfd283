"""One step of the world; the only place where physics, sensors and traffic meet."""

from linden.simulation.simulation import Simulation

__all__ = ["Simulation"]
