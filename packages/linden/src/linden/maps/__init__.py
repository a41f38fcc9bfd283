"""Maps: OpenDRIVE, ground heights, the walking mesh, derived facts and their cache."""
