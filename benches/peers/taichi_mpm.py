"""MLS-MPM in Taichi: 3D, quadratic splines, APIC, double precision, linear elastic in rate form, dense grid.

After Y. Hu, Y. Fang, Z. Ge, Z. Qu, Y. Zhu, A. Pradhana, C. Jiang, ACM Trans. Graph. 37 (2018) 150,
doi:10.1145/3197517.3201293, written as Taichi's own examples are. Arguments: folder of the scene, threads, and `atomic` (as
Taichi ships: `+=` on the grid is atomic) or `plain` (load, add, store: right on one thread only).
"""

import sys

from scene import Scene, serve  # before the libraries that print

import taichi as ti

scene = Scene(sys.argv[1])
THREADS, ATOMIC = int(sys.argv[2]), sys.argv[3] == "atomic"
if THREADS > 1 and not ATOMIC:
    sys.exit("without atomics the result is right on one thread only")
ti.init(
    arch=ti.cpu,
    default_fp=ti.f64,
    cpu_max_num_threads=THREADS,
    offline_cache=False,
    log_level=ti.WARN,
)

N, COUNT = scene.nodes, len(scene.x)
H, DT, LAM, MU, MASS = scene.h, scene.dt, scene.lam, scene.mu, scene.mass

x = ti.Vector.field(3, float, COUNT)  # position [m]
v = ti.Vector.field(3, float, COUNT)  # velocity [m/s]
C = ti.Matrix.field(3, 3, float, COUNT)  # affine velocity matrix [1/s]
stress = ti.Matrix.field(3, 3, float, COUNT)  # Cauchy stress [Pa]
volume = ti.field(float, COUNT)  # [m^3]
grid_v = ti.Vector.field(3, float, (N, N, N))  # momentum, then velocity
grid_m = ti.field(float, (N, N, N))  # mass


@ti.func
def stencil(position):
    """Lowest node of the stencil, place relative to it, weights along each axis."""
    xi = position / H
    base = int(xi - 0.5)
    f = xi - base
    return base, f, [0.5 * (1.5 - f) ** 2, 0.75 - (f - 1.0) ** 2, 0.5 * (f - 0.5) ** 2]


@ti.kernel
def step():
    for i in ti.grouped(grid_m):
        grid_v[i] = ti.Vector.zero(float, 3)
        grid_m[i] = 0.0
    for p in x:  # particles to grid, the force in the affine momentum
        base, f, w = stencil(x[p])
        affine = -DT * volume[p] * 4.0 / H**2 * stress[p] + MASS * C[p]
        for offset in ti.static(ti.grouped(ti.ndrange(3, 3, 3))):
            r = (offset.cast(float) - f) * H
            weight = w[offset[0]][0] * w[offset[1]][1] * w[offset[2]][2]
            momentum = weight * (MASS * v[p] + affine @ r)
            i = base + offset
            if ti.static(ATOMIC):
                grid_v[i] += momentum
                grid_m[i] += weight * MASS
            else:
                grid_v[i] = grid_v[i] + momentum
                grid_m[i] = grid_m[i] + weight * MASS
    for i in ti.grouped(grid_m):
        if grid_m[i] > 0.0:
            grid_v[i] = grid_v[i] / grid_m[i]
    for p in x:  # grid to particles, then the stress: Jaumann's rate
        base, f, w = stencil(x[p])
        new_v = ti.Vector.zero(float, 3)
        B = ti.Matrix.zero(float, 3, 3)
        for offset in ti.static(ti.grouped(ti.ndrange(3, 3, 3))):
            weight = w[offset[0]][0] * w[offset[1]][1] * w[offset[2]][2]
            node_v = weight * grid_v[base + offset]
            new_v += node_v
            B += node_v.outer_product(offset.cast(float) - f)
        L = 4.0 / H * B
        v[p], C[p] = new_v, L
        x[p] += DT * new_v
        strain, spin = 0.5 * DT * (L + L.transpose()), 0.5 * DT * (L - L.transpose())
        s = stress[p]
        trace = strain.trace()
        identity = ti.Matrix.identity(float, 3)
        stress[p] = s + spin @ s - s @ spin + LAM * trace * identity + 2.0 * MU * strain
        volume[p] *= 1.0 + trace


class Peer:
    def __init__(self):
        x.from_numpy(scene.x)
        v.from_numpy(scene.v)
        volume.fill(scene.volume)

    def steps(self, n):
        for _ in range(n):
            step()
        ti.sync()

    def state(self):
        return x.to_numpy(), v.to_numpy()


serve(Peer(), scene)
