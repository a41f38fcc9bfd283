"""OpenDRIVE 1.4: parse, evaluate, mesh, place signals."""
