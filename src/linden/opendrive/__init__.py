"""OpenDRIVE 1.4: parse, place, mesh, check and draw; a map library usable on its own."""
