"""Cases of BASU as OpenSCENARIO files: triggers as conditions, motions as trajectories of a rehearsal."""
