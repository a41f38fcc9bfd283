"""From XML elements to the values of :mod:`linden.opendrive.model`, one file a family of elements."""
