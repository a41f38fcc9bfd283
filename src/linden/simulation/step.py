"""One step of the world, stage after stage: lights, bodies, then what the snapshot shows of them."""

from linden.simulation.episode import Episode
from linden.simulation.spawning import destroy


def step(episode: Episode, dt_s: float, substeps: int) -> None:
    """Let ``dt_s`` pass in an episode; the physics takes it in ``substeps`` equal parts."""
    episode.actors.turn_page()
    episode.traffic.step(dt_s)
    episode.grip.update(episode)
    episode.contacts = episode.foresight.advance(episode.bodies, episode.map.ground, episode.statics, dt_s, substeps)
    episode.elapsed_s += dt_s
    for actor_id in episode.walkers.step(episode, dt_s):
        destroy(episode, actor_id, announce=True)
    episode.surroundings.step(episode.elapsed_s)
    episode.sockets.follow(episode)
    episode.observe()


def look_ahead(episode: Episode, dt_s: float, substeps: int) -> None:
    """Compute the bodies of the next step ahead of time; nothing of the episode changes."""
    episode.foresight.look_ahead(episode.bodies, episode.map.ground, episode.statics, dt_s, substeps)
