"""OpenSCENARIO files as cases of BASU: an agent drives one entity, and the others move as written."""
