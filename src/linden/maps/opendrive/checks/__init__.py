"""What can be wrong with a map, one family of mistakes a file; each check is a function from a map to findings."""
