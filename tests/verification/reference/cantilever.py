#!/usr/bin/env python3
"""Deflection and shortening of the cantilevers of case D9 that the elastica does not describe: a beam ten times as long as deep.

Moment over curvature comes from the exact bending of a block by Hencky's law in plane strain: sections stay plane, the radial stress
is in equilibrium and vanishes on both faces. The beam equation takes it together with the strain of the axis, N / (E' A), and the
shear, V / (5/6 G A). The elastica itself is printed as a check: .80624 and .54613 for a force with k = 9.6.
"""
import math

E, NU, LENGTH, DEPTH = 12e6, 0.2, 10.0, 1.0
LAMBDA, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
PLANE = E / (1 - NU * NU)
BENDING, AXIAL, SHEAR = PLANE * DEPTH**3 / 12, PLANE * DEPTH, 5 / 6 * MU * DEPTH


def cauchy(radial, hoop):
    """Radial and hoop stress of logarithmic strains."""
    trace = LAMBDA * (radial + hoop)
    scale = math.exp(-(radial + hoop))
    return scale * (trace + 2 * MU * radial), scale * (trace + 2 * MU * hoop)


def radial_strain(stress, hoop, guess):
    for _ in range(30):
        value = cauchy(guess, hoop)[0]
        step = (value - stress) / (math.exp(-guess - hoop) * (LAMBDA + 2 * MU) - value)
        guess -= step
        if abs(step) < 1e-14:
            break
    return guess


def bend(curvature, inner, n=100):
    """Radial stress on the outer face and moment, if the inner face has this radius."""
    dz, r, stress, moment, guess = DEPTH / n, inner, 0.0, 0.0, 0.0

    def rates(r, stress):
        hoop = math.log(curvature * r)
        strain = radial_strain(stress, hoop, guess)
        along, stretch = cauchy(strain, hoop)[1], math.exp(strain)
        return stretch, stretch * (along - stress) / r, stretch * along * r

    for _ in range(n):
        k = [rates(r, stress)]
        for part in (0.5, 0.5, 1.0):
            k.append(rates(r + part * dz * k[-1][0], stress + part * dz * k[-1][1]))
        mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(*k)]
        r, stress, moment = r + dz * mean[0], stress + dz * mean[1], moment + dz * mean[2]
    return stress, moment


def secant(f, a, b, tolerance):
    fa, fb = f(a), f(b)
    for _ in range(60):
        if abs(fb) < tolerance:
            break
        a, fa, b = b, fb, b - fb * (b - a) / (fb - fa)
        fb = f(b)
    return b


def softening():
    """Curvatures and M / (E' I kappa)."""
    table = [(0.0, 1.0)]
    for k in range(1, 31, 2):
        curvature = 0.02 * k
        inner = 1 / curvature - DEPTH / 2
        inner = secant(lambda r: bend(curvature, r)[0], inner, inner + 0.01, 1e-3)
        table.append((curvature, bend(curvature, inner)[1] / (BENDING * curvature)))
    return table


def curvature_of(moment, table):
    curvature = linear = moment / BENDING
    for _ in range(30):
        c = abs(curvature)
        ratio = table[-1][1]
        for (a, x), (b, y) in zip(table, table[1:]):
            if c <= b:
                ratio = x + (y - x) * (c - a) / (b - a)
                break
        curvature = linear / ratio
    return curvature


def beam(load, k, table, slender, n=400):
    """Shortening and deflection over the length."""
    force, ds = k * BENDING / LENGTH**2, LENGTH / n

    def shoot(moment):
        x = y = angle = 0.0

        def rates(s, angle, moment):
            v = force if load == "end" else force * (1 - s / LENGTH)
            shear = 0.0 if slender else v * math.cos(angle) / SHEAR
            strain = 0.0 if slender else v * math.sin(angle) / AXIAL
            dx = (1 + strain) * math.cos(angle) - shear * math.sin(angle)
            dy = (1 + strain) * math.sin(angle) + shear * math.cos(angle)
            return dx, dy, curvature_of(moment, table), -v * dx

        for i in range(n):
            a = rates(i * ds, angle, moment)
            b = rates((i + 0.5) * ds, angle + 0.5 * ds * a[2], moment + 0.5 * ds * a[3])
            x, y, angle, moment = x + ds * b[0], y + ds * b[1], angle + ds * b[2], moment + ds * b[3]
        return moment, x, y

    root = secant(lambda m: shoot(m)[0], 3 * force, 5 * force, 1e-6 * BENDING)
    _, x, y = shoot(root)
    return 1 - x / LENGTH, y / LENGTH


if __name__ == "__main__":
    hencky = softening()
    for load, k in (("end", 9.6), ("end", 1.0), ("end", 2.0), ("weight", 8.0)):
        elastica = beam(load, k, [(0.0, 1.0), (9.0, 1.0)], True)
        thick = beam(load, k, hencky, False)
        print(load, k, "elastica %.5f %.5f, beam %.5f %.5f" % (*elastica, *thick))
