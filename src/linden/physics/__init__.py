"""How bodies move: stages of a step, one idea a file, over structure-of-arrays. Start at ``step.advance``."""
