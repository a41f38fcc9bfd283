"""Traffic rules of the basic agent: stop and yield signs, lights, service stops, gap acceptance, obstacles, leaders."""
