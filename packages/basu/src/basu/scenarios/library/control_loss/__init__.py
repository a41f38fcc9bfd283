"""The ego loses control of itself: scenario I of the thesis, and a second."""
