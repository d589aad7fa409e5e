"""Where each of a swarm's objects is at a time: what swarm.py flies, and against which observer.py measures."""
import numpy as np

RADIUS_M = 20.0


class Flight:
    """Each object goes round on a Lissajous curve of its own, at 3 to 9 m/s, and looks where it goes."""

    def __init__(self, count, seed):
        self.count, self.seed = count, seed
        random = np.random.default_rng(seed)
        self.rate = random.uniform(0.15, 0.3, (2, count))  # [rad/s] along x and z
        self.phase = random.uniform(0, 2 * np.pi, (2, count))
        self.height_m = random.uniform(1, 8, count)

    def at(self, t):
        """Poses (count, 7) and velocities (count, 3) at session time t [s]."""
        angle = self.rate * t + self.phase
        poses, velocities = np.zeros((self.count, 7)), np.zeros((self.count, 3))
        poses[:, 0], poses[:, 2] = RADIUS_M * np.sin(angle)
        poses[:, 1] = self.height_m
        velocities[:, 0], velocities[:, 2] = RADIUS_M * self.rate * np.cos(angle)
        # In VRML an object's nose points along -z; turning by `heading` about y takes it along the velocity.
        heading = np.arctan2(-velocities[:, 0], -velocities[:, 2])
        poses[:, 4], poses[:, 6] = np.sin(heading / 2), np.cos(heading / 2)
        return poses, velocities
