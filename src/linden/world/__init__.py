"""What there is: actors, blueprints, maps and the look-ups over them."""
