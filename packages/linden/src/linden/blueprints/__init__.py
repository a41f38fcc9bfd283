"""The blueprint library: every kind of actor, its attributes, sizes and skeleton."""
