"""The kinematic player: the states of a storyboard, conditions, and actions that move entities without dynamics."""
