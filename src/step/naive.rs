//! The step as the textbook writes it: the oracle of every fast kernel. No blocks, no tiles, no threads.

use crate::boundary::Wall;
use crate::shape::ShapeKind;
use crate::step::StepOrder;
use crate::transfer::{TransferKind, pic_flip::pic_share};
use crate::world::options::Options;
use nalgebra::{SMatrix, SVector};
use std::{array::from_fn, collections::HashMap};

type Vector<const D: usize> = SVector<f64, D>;
type Matrix<const D: usize> = SMatrix<f64, D, D>;
/// A particle: position, velocity, affine matrix, mass, volume, stress in the axes of the world.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct Particle<const D: usize> {
    pub x: Vector<D>,
    pub v: Vector<D>,
    pub c: Matrix<D>,
    pub mass: f64,
    pub volume: f64,
    pub stress: Matrix<D>,
}

/// A node: mass, momentum, force, velocity, its increment, the velocity that gradients are taken of.
struct Node<const D: usize> {
    m: f64,
    mv: Vector<D>,
    f: Vector<D>,
    v: Vector<D>,
    dv: Vector<D>,
    last: Vector<D>,
}

/// Weight and slope [1/h] at the distance r = (x_p − x_i) / h.
fn weight(shape: ShapeKind, r: f64) -> (f64, f64) {
    let (a, sign) = (r.abs(), r.signum());
    match shape {
        ShapeKind::Linear if a < 1.0 => (1.0 - a, -sign),
        ShapeKind::QuadraticBspline if a < 0.5 => (0.75 - r * r, -2.0 * r),
        ShapeKind::QuadraticBspline if a < 1.5 => (0.5 * (1.5 - a).powi(2), -sign * (1.5 - a)),
        _ => (0.0, 0.0),
    }
}

/// A node near a particle: index, w, ∇w, r = x_i − x_p.
type Near<const D: usize> = ([i64; D], f64, Vector<D>, Vector<D>);
fn near<const D: usize>(o: &Options, x: Vector<D>) -> impl Iterator<Item = Near<D>> {
    let xi: [f64; D] = from_fn(|d| (x[d] - o.origin[d]) / o.spacing);
    let (shape, h) = (o.shape, o.spacing);
    (0..4usize.pow(D as u32)).filter_map(move |n| {
        let i = from_fn(|d| xi[d].floor() as i64 - 1 + (n / 4usize.pow(d as u32) % 4) as i64);
        let axis = |d: usize| weight(shape, xi[d] - i[d] as f64);
        let slope = |d, e| if d == e { axis(e).1 / h } else { axis(e).0 };
        let w = (0..D).map(|d| axis(d).0).product();
        let dw = Vector::from_fn(|d, _| (0..D).map(|e| slope(d, e)).product());
        (w > 0.0).then(|| (i, w, dw, Vector::from_fn(|d, _| (i[d] as f64 - xi[d]) * h)))
    })
}

/// Applies the walls to a node's velocity.
fn walled<const D: usize>(o: &Options, walls: &[Wall], i: &[i64; D], v: Vector<D>) -> Vector<D> {
    let acts = |w: &&Wall| {
        let x = o.origin[w.axis] + i[w.axis] as f64 * o.spacing;
        (x - w.position) * f64::from(w.side) <= (o.shape.wall_reach() + 1e-9) * o.spacing
    };
    walls.iter().filter(acts).fold(v, |v, wall| wall.constrain(v.into()).into())
}

/// One step of length `dt` [s]; `update_stress` gets each particle with its velocity gradient [1/s].
pub fn step<const D: usize>(
    (o, walls): (&Options, &[Wall]),
    particles: &mut [Particle<D>],
    dt: f64,
    mut update_stress: impl FnMut(&mut Particle<D>, &Matrix<D>),
) {
    let (mut grid, z) = (HashMap::<[i64; D], Node<D>>::new(), Vector::zeros());
    for p in particles.iter() {
        for (i, w, dw, r) in near(o, p.x) {
            let n = grid.entry(i).or_insert(Node { m: 0.0, mv: z, f: z, v: z, dv: z, last: z });
            n.m += w * p.mass;
            n.mv += w * p.mass * (p.v + p.c * r);
            n.f -= p.volume * p.stress * dw;
        }
    }
    for (i, n) in &mut grid {
        let (old, g) = (n.mv / n.m, Vector::<D>::from_fn(|a, _| o.gravity[a]));
        let a: Vector<D> = n.f / n.m + g;
        let damping = a.zip_map(&old, |a, v| o.damping * a.abs() * v.signum());
        n.v = walled(o, walls, i, old + dt * (a - damping));
        n.dv = n.v - old;
    }
    let (share, affine) = (pic_share(o.pic_rate, dt), o.transfer == TransferKind::Apic);
    for p in particles.iter_mut() {
        let (mut pic, mut flip, mut c) = (Vector::zeros(), p.v, Matrix::zeros());
        for (i, w, dw, r) in near(o, p.x) {
            let linear = o.shape == ShapeKind::Linear;
            pic += w * grid[&i].v;
            flip += w * grid[&i].dv;
            c += grid[&i].v * if linear { dw } else { r * w * 4.0 / o.spacing.powi(2) }.transpose();
        }
        p.v = if affine { pic } else { (1.0 - share) * flip + share * pic };
        p.c = if affine { c } else { Matrix::zeros() };
        let spread = |r: Vector<D>| p.mass * (p.v + p.c * r);
        near(o, p.x).for_each(|(i, w, _, r)| grid.get_mut(&i).unwrap().last += w * spread(r));
    }
    for (i, n) in &mut grid {
        let again = walled(o, walls, i, n.last / n.m);
        n.last = if o.order == StepOrder::Musl { again } else { n.v };
    }
    for p in particles {
        let mut l = Matrix::zeros();
        for (i, w, dw, _) in near(o, p.x) {
            p.x += dt * w * grid[&i].v;
            l += grid[&i].last * dw.transpose();
        }
        p.volume *= (l.trace() * dt).exp();
        update_stress(p, &l);
    }
}
