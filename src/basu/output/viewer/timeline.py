"""The one timeline of all that is shown, so that one seed gives one recording."""

TIMELINE = "simulated_time"  # s since the run's first tick
