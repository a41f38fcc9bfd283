"""What a person reads and looks at after a run."""
