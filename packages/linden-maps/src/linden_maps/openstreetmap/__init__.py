"""OpenStreetMap extracts as street facts: reading, meaning of tags, graph, controls, buildings."""
