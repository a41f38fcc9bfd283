"""The engine of jobs: plain data in, answers out, played by workers that stay alive between jobs.

`playing` plays a list of jobs, with a pool or in this process. `pool` gives jobs to workers and tries a job again where
its worker died. Its workers are processes of this machine (`processes`) or actors of a Ray cluster (`cluster`). A
`player` is what a worker holds between jobs: for drives a simulator, its map and the agents.
"""
