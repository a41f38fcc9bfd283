"""Agents in processes of their own: whatever an agent does to its process, the benchmark goes on and judges it."""
