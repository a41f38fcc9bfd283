"""The window on the world: a page in the browser that shows a running world or a recorded drive in three dimensions."""
