"""What a shuttle meets besides: at its stops, and in its own steering. No part of NHTSA's typology."""
