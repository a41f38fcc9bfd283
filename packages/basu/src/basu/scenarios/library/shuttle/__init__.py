"""Shuttle scenarios outside NHTSA's typology: situations at service stops, and a deviation of the steering."""
