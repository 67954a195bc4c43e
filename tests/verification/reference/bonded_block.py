#!/usr/bin/env python3
"""Apparent modulus of a bonded block in plane strain, the reference of case L1.

A quarter, 2 m x 0.5 m, is bonded to a plate at y = 0.5 m that comes down by a unit; E = 1. Mixed finite elements: nine-node
displacements and discontinuous linear pressures (Q2/P-1, stable for any Poisson's ratio), in a mesh that is graded towards the edge
where the plate ends. The modulus is twice the energy over the squared strain and the volume; it falls to the limit as the mesh is
refined.
"""
import sys

A, B = 2.0, 0.5
GAUSS = [(-(0.6**0.5), 5 / 9), (0.0, 8 / 9), (0.6**0.5, 5 / 9)]


def shape(s):
    """Values and slopes of the quadratic polynomials on -1, 0, 1."""
    return [s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2], [s - 0.5, -2 * s, s + 0.5]


def graded(length, n, ratio):
    """Node coordinates of n elements from 0 to length, each smaller than the one before."""
    sizes = [ratio**k for k in range(n)]
    scale, x = length / sum(sizes), [0.0]
    for size in sizes:
        x += [x[-1] + 0.5 * size * scale, x[-1] + size * scale]
    return x


def element(hx, hy, lam, mu):
    """Stiffness of an element, dilation projected on 1, s, t."""
    k = [[0.0] * 18 for _ in range(18)]
    g = [[0.0] * 18 for _ in range(3)]
    mass = [0.0] * 3
    for s, ws in GAUSS:
        for t, wt in GAUSS:
            (fs, ds), (ft, dt) = shape(s), shape(t)
            w = ws * wt * hx * hy / 4
            dx = [ds[i] * ft[j] * 2 / hx for j in range(3) for i in range(3)]
            dy = [fs[i] * dt[j] * 2 / hy for j in range(3) for i in range(3)]
            for a in range(9):
                for b in range(9):
                    k[2 * a][2 * b] += w * mu * (2 * dx[a] * dx[b] + dy[a] * dy[b])
                    k[2 * a][2 * b + 1] += w * mu * dy[a] * dx[b]
                    k[2 * a + 1][2 * b] += w * mu * dx[a] * dy[b]
                    k[2 * a + 1][2 * b + 1] += w * mu * (2 * dy[a] * dy[b] + dx[a] * dx[b])
                for m, q in enumerate((1, s, t)):
                    g[m][2 * a] += w * q * dx[a]
                    g[m][2 * a + 1] += w * q * dy[a]
            for m, q in enumerate((1, s, t)):
                mass[m] += w * q * q
    for i in range(18):
        for j in range(18):
            k[i][j] += sum(lam * g[m][i] * g[m][j] / mass[m] for m in range(3))
    return k


def modulus(nu, nx, ny, ratio):
    lam, mu = nu / ((1 + nu) * (1 - 2 * nu)), 0.5 / (1 + nu)
    x, y = graded(A, nx, ratio ** (ny / nx)), graded(B, ny, ratio)
    rows, columns = len(y), len(x)
    number = {}
    for i in range(columns):
        for j in range(rows):
            top = j == rows - 1
            for c, fixed in ((0, i == 0 or top), (1, j == 0 or top)):
                if not fixed:
                    number[i, j, c] = len(number)
    n, band = len(number), 4 * rows + 6
    matrix, load, energy = [[0.0] * band for _ in range(n)], [0.0] * n, 0.0
    for ex in range(nx):
        for ey in range(ny):
            k = element(x[2 * ex + 2] - x[2 * ex], y[2 * ey + 2] - y[2 * ey], lam, mu)
            nodes = [(2 * ex + i, 2 * ey + j) for j in range(3) for i in range(3)]
            dofs = [(i, j, c) for i, j in nodes for c in (0, 1)]
            given = [-1.0 if c == 1 and j == rows - 1 else 0.0 for i, j, c in dofs]
            for a, da in enumerate(dofs):
                row = number.get(da)
                for b, db in enumerate(dofs):
                    if row is None:
                        energy += 0.5 * given[a] * k[a][b] * given[b]
                        continue
                    column = number.get(db)
                    if column is None:
                        load[row] -= k[a][b] * given[b]
                    elif column <= row:
                        matrix[row][row - column] += k[a][b]
    # Cholesky: matrix[i][d] is the entry (i, i - d)
    right = load[:]
    for i in range(n):
        row = matrix[i]
        for d in range(min(band - 1, i), -1, -1):
            other = matrix[i - d]
            value = row[d] - sum(map(float.__mul__, row[d + 1 :], other[1 : band - d]))
            row[d] = value / other[0] if d else value**0.5
        right[i] = (right[i] - sum(row[d] * right[i - d] for d in range(1, min(band - 1, i) + 1))) / row[0]
    energy -= 0.5 * sum(value * value for value in right)
    return 2 * energy / ((1 / B) ** 2 * A * B)


if __name__ == "__main__":
    for nu in map(float, sys.argv[1:] or ["0.499", "0.4999"]):
        for nx, ny, ratio in ((4, 4, 0.7), (8, 6, 0.7), (12, 8, 0.7), (16, 10, 0.7)):
            print(nu, nx, ny, modulus(nu, nx, ny, ratio), flush=True)
