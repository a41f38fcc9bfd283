"""One step of the world; the only place where physics, sensors and traffic meet."""
