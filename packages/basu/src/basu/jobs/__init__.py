"""The engine of jobs: plain data in, results out, played by workers that stay alive between jobs.

`playing` plays a list of jobs, with a pool or in this process.
`pool` gives jobs to workers. If a worker dies, the pool tries its job again.
The workers are processes of this machine (`processes`) or actors of a Ray cluster (`cluster`).
`player` says what a worker holds between jobs: for drives a simulator, its map and the agents.
"""
