"""OpenSCENARIO XML for BASU: a reader of files, plain roads in double precision, and a kinematic player."""
