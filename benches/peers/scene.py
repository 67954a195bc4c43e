"""What both peers share: the scene that the bench wrote, and the commands that it sends.

The scene is a folder with `scene.json` (numbers in SI units) and `position.bin`, `velocity.bin` (doubles, x y z of each
particle). A peer is a class with `steps(n)`, which returns when n steps are done, and `state()`, which gives positions and
velocities as arrays of shape [particles, 3].
"""

import json
import os
import pathlib
import sys
import time

import numpy as np

answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what the libraries print goes to standard error


class Scene:
    """The block of elastic material: particles, spacing h [m], step dt [s], Lame's constants [Pa], a dense grid."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        numbers = json.loads((folder / "scene.json").read_text())
        self.h, self.dt = numbers["spacing"], numbers["dt"]
        self.lam, self.mu = numbers["lambda"], numbers["shear_modulus"]
        self.mass, self.volume = numbers["mass"], numbers["volume"]  # of one particle [kg], [m^3]
        self.nodes = numbers["nodes"]  # of the dense grid along each axis
        self.corner = numbers["corner"]  # of the grid on every axis [m]
        self.x = np.fromfile(folder / "position.bin").reshape(-1, 3) - self.corner
        self.v = np.fromfile(folder / "velocity.bin").reshape(-1, 3)


def serve(peer, scene):
    """Obeys standard input: `steps N` is answered with seconds, `end` with the state."""
    print(json.dumps({"particles": len(scene.x)}), file=answers, flush=True)
    for line in sys.stdin:
        command, *number = line.split()
        if command == "steps":
            start = time.perf_counter()
            peer.steps(int(number[0]))
            print(time.perf_counter() - start, file=answers, flush=True)
        elif command == "end":
            x, v = peer.state()
            center = (x.mean(axis=0) + scene.corner).tolist()
            energy = 0.5 * scene.mass * float((v * v).sum())
            state = {"center_of_mass": center, "kinetic_energy": energy}
            print(json.dumps(state), file=answers, flush=True)
            return
        else:
            sys.exit(f"no command is named {command}")
