"""The agents that come with BASU, and the parts that they are made of."""
