"""What the basic agent stops and waits for: one rule of the road a file, each a state machine of its own."""
