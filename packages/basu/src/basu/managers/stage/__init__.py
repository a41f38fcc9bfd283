"""The stage of a scenario in a live simulator: its actors, and how they are led."""
