"""MLS-MPM in Warp: 3D, quadratic splines, APIC, double precision, linear elastic in rate form, dense grid, on the CPU.

After Y. Hu, Y. Fang, Z. Ge, Z. Qu, Y. Zhu, A. Pradhana, C. Jiang, ACM Trans. Graph. 37 (2018) 150,
doi:10.1145/3197517.3201293. Warp runs a kernel on one thread of the CPU. Argument: folder of the scene.
"""

import pathlib
import sys

from scene import Scene, serve  # before the libraries that print

import numpy as np
import warp as wp

scene = Scene(sys.argv[1])
wp.config.quiet, wp.config.enable_backward = True, False
wp.config.kernel_cache_dir = str(pathlib.Path(sys.argv[1]) / "warp")
wp.init()

N, COUNT = scene.nodes, len(scene.x)
NUMBERS = (scene.h, scene.dt, scene.mass, scene.lam, scene.mu)
H, DT, MASS, LAM, MU = (wp.constant(wp.float64(number)) for number in NUMBERS)
HALF, ONE, TWO, FOUR = (wp.constant(wp.float64(number)) for number in (0.5, 1.0, 2.0, 4.0))
NEAR, FAR = wp.constant(wp.float64(0.75)), wp.constant(wp.float64(1.5))


@wp.func
def weights(f: wp.vec3d):
    """Row n, axis d: weight of node n of the stencil along the axis."""
    a = wp.vec3d(FAR - f[0], FAR - f[1], FAR - f[2])
    b = wp.vec3d(f[0] - ONE, f[1] - ONE, f[2] - ONE)
    c = wp.vec3d(f[0] - HALF, f[1] - HALF, f[2] - HALF)
    near = wp.vec3d(NEAR, NEAR, NEAR)
    a, b, c = wp.cw_mul(a, a), wp.cw_mul(b, b), wp.cw_mul(c, c)
    return wp.matrix_from_rows(HALF * a, near - b, HALF * c)


@wp.kernel
def particles_to_grid(
    x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), C: wp.array(dtype=wp.mat33d),
    stress: wp.array(dtype=wp.mat33d), volume: wp.array(dtype=wp.float64),
    grid_v: wp.array3d(dtype=wp.vec3d), grid_m: wp.array3d(dtype=wp.float64),
):  # fmt: skip
    p = wp.tid()
    xi = x[p] / H
    i = wp.int32(xi[0] - HALF)
    j = wp.int32(xi[1] - HALF)
    k = wp.int32(xi[2] - HALF)
    f = wp.vec3d(xi[0] - wp.float64(i), xi[1] - wp.float64(j), xi[2] - wp.float64(k))
    w = weights(f)
    affine = (-DT * volume[p] * FOUR / (H * H)) * stress[p] + MASS * C[p]  # the force in it
    for a in range(3):
        for b in range(3):
            for c in range(3):
                node = wp.vec3d(wp.float64(i + a), wp.float64(j + b), wp.float64(k + c))
                weight = w[a, 0] * w[b, 1] * w[c, 2]
                momentum = weight * (MASS * v[p] + affine * (H * (node - xi)))
                wp.atomic_add(grid_v, i + a, j + b, k + c, momentum)
                wp.atomic_add(grid_m, i + a, j + b, k + c, weight * MASS)


@wp.kernel
def update_grid(grid_v: wp.array3d(dtype=wp.vec3d), grid_m: wp.array3d(dtype=wp.float64)):
    i, j, k = wp.tid()
    if grid_m[i, j, k] > wp.float64(0.0):
        grid_v[i, j, k] = grid_v[i, j, k] / grid_m[i, j, k]


@wp.kernel
def grid_to_particles(
    x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), C: wp.array(dtype=wp.mat33d),
    stress: wp.array(dtype=wp.mat33d), volume: wp.array(dtype=wp.float64),
    grid_v: wp.array3d(dtype=wp.vec3d),
):  # fmt: skip
    p = wp.tid()
    xi = x[p] / H
    i = wp.int32(xi[0] - HALF)
    j = wp.int32(xi[1] - HALF)
    k = wp.int32(xi[2] - HALF)
    f = wp.vec3d(xi[0] - wp.float64(i), xi[1] - wp.float64(j), xi[2] - wp.float64(k))
    w = weights(f)
    new_v = wp.vec3d()
    B = wp.mat33d()
    for a in range(3):
        for b in range(3):
            for c in range(3):
                node = wp.vec3d(wp.float64(i + a), wp.float64(j + b), wp.float64(k + c))
                node_v = (w[a, 0] * w[b, 1] * w[c, 2]) * grid_v[i + a, j + b, k + c]
                new_v += node_v
                B += wp.outer(node_v, node - xi)
    L = (FOUR / H) * B
    v[p] = new_v
    C[p] = L
    x[p] = x[p] + DT * new_v
    strain = (HALF * DT) * (L + wp.transpose(L))
    spin = (HALF * DT) * (L - wp.transpose(L))
    s = stress[p]
    trace = wp.trace(strain)
    identity = wp.identity(n=3, dtype=wp.float64)
    rotated = s + spin * s - s * spin  # Jaumann's rate
    stress[p] = rotated + (LAM * trace) * identity + (TWO * MU) * strain
    volume[p] = volume[p] * (ONE + trace)


class Peer:
    def __init__(self):
        with wp.ScopedDevice("cpu"):
            self.x = wp.array(scene.x, dtype=wp.vec3d)
            self.v = wp.array(scene.v, dtype=wp.vec3d)
            self.C = wp.zeros(COUNT, dtype=wp.mat33d)
            self.stress = wp.zeros(COUNT, dtype=wp.mat33d)
            self.volume = wp.array(np.full(COUNT, scene.volume), dtype=wp.float64)
            self.grid_v = wp.zeros((N, N, N), dtype=wp.vec3d)
            self.grid_m = wp.zeros((N, N, N), dtype=wp.float64)

    def steps(self, n):
        particles = [self.x, self.v, self.C, self.stress, self.volume]
        for _ in range(n):
            self.grid_v.zero_()
            self.grid_m.zero_()
            grid = [self.grid_v, self.grid_m]
            wp.launch(particles_to_grid, COUNT, particles + grid, device="cpu")
            wp.launch(update_grid, (N, N, N), grid, device="cpu")
            wp.launch(grid_to_particles, COUNT, particles + [self.grid_v], device="cpu")

    def state(self):
        return self.x.numpy(), self.v.numpy()


serve(Peer(), scene)
