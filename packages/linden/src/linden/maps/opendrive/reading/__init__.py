"""From XML elements to the values of :mod:`linden.maps.opendrive.model`, one file a family of elements."""
