//! What the textbook's step does with nodes: weights, walls, sums to the grid and back, strain.

use crate::background::Held;
use crate::boundary::{Wall, WallKind, law::constrain};
use crate::shape::{ShapeKind, WallTreatment, textbook::Between};
use crate::step::options::Options;
use crate::transfer::TransferKind;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use std::{array::from_fn, collections::BTreeMap};

/// A vector in D dimensions.
pub type Vector<const D: usize> = SVector<f64, D>;
/// A matrix in D dimensions.
pub type Matrix<const D: usize> = SMatrix<f64, D, D>;
/// A particle: position, velocity, affine matrix, mass, volume, stress in the axes of the world and
/// of the hoop, edges, body force, deformation gradient.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct Particle<const D: usize> {
    pub x: Vector<D>,
    pub v: Vector<D>,
    pub c: Matrix<D>,
    pub mass: f64,
    pub volume: f64,
    pub stress: Matrix<D>,
    pub hoop_stress: f64,
    pub size: Vector<D>,
    pub body_force: Vector<D>,
    pub f: Matrix3<f64>,
}

/// A node: mass, momentum, force, velocity, its increment, the velocity that particles take, and
/// that gradients are taken of; and what walls hold.
#[derive(Clone, Copy)]
pub struct Node<const D: usize>(pub f64, pub [Vector<D>; 6], pub Held);
/// The fields of a node.
pub const MV: usize = 0;
#[allow(missing_docs)]
pub const F: usize = 1;
#[allow(missing_docs)]
pub const V: usize = 2;
#[allow(missing_docs)]
pub const DV: usize = 3;
#[allow(missing_docs)]
pub const U: usize = 4;
#[allow(missing_docs)]
pub const LAST: usize = 5;
/// The grid.
pub type Grid<const D: usize> = BTreeMap<[i64; D], Node<D>>;
/// What the step needs beside the particles.
pub type Setup<'a> = (&'a Options, &'a [Wall]);
/// Updates a particle of which velocity gradient, hoop rate and time step are given.
pub type Update<'a, const D: usize> = dyn FnMut(&mut Particle<D>, &Matrix<D>, f64, f64) + 'a;

/// A node near a particle: index, w, ∇w, r = x_i − x_p.
pub type Near<const D: usize> = ([i64; D], f64, Vector<D>, Vector<D>);
/// The nodes near a particle.
pub fn near<const D: usize>(s: Setup<'_>, p: &Particle<D>) -> Vec<Near<D>> {
    let (o, h, between) = (s.0, s.0.spacing, between_walls::<D>(s));
    let xi: [f64; D] = from_fn(|d| (p.x[d] - o.origin[d]) / h);
    let node = |n: usize| {
        let i: [i64; D] =
            from_fn(|d| between[d].cell(xi[d]) - 1 + (n / 4usize.pow(d as u32) % 4) as i64);
        let axis: [(f64, f64); D] =
            from_fn(|d| between[d].weight(o.shape, i[d], xi[d], 0.5 * p.size[d] / h));
        let slope = |d: usize, e: usize| if d == e { axis[e].1 / h } else { axis[e].0 };
        let (w, r) = (
            (0..D).map(|d| axis[d].0).product::<f64>(),
            Vector::from_fn(|d, _| between[d].distance(i[d], xi[d]) * h),
        );
        let dw = Vector::from_fn(|d, _| {
            let mls = o.transfer == TransferKind::Mls && !is_modified(s, p, d);
            let by_axes = (0..D).map(|e| slope(d, e)).product();
            if mls { r[d] * w * moment(o.shape) / (h * h) } else { by_axes }
        });
        let behind = (0..D).any(|d| i[d] < between[d].nodes[0] || i[d] > between[d].nodes[1]);
        (w > 0.0 && !behind).then_some((i, w, dw, r))
    };
    (0..4usize.pow(D as u32)).filter_map(node).collect()
}

/// The walls that modify the shape functions along each axis; linear ones too.
fn between_walls<const D: usize>((o, walls): Setup<'_>) -> [Between; D] {
    let mut between = [[f64::NEG_INFINITY, f64::INFINITY]; D];
    for wall in walls.iter().filter(|_| o.wall_treatment == WallTreatment::Modified) {
        let [low, high] = &mut between[wall.axis];
        let xi = (wall.position - o.origin[wall.axis]) / o.spacing;
        if wall.side > 0 { *low = low.max(xi) } else { *high = high.min(xi) }
    }
    between.map(Between::new)
}

/// Whether walls make weights or distances of nodes other than elsewhere along axis d: a function
/// reaches behind a wall, or the node of a wall has moved and the function reaches it.
pub fn is_modified<const D: usize>(s: Setup<'_>, p: &Particle<D>, d: usize) -> bool {
    let xi = (p.x[d] - s.0.origin[d]) / s.0.spacing;
    let between = between_walls::<D>(s)[d];
    let [low, high] = between.nodes.map(|node| node as f64);
    let radius = 0.5 * s.0.shape.nodes() as f64;
    (xi - low).min(high - xi) < radius - f64::from(!between.moved())
}

/// 1 / Σ w r², in units of 1 / h².
pub fn moment(shape: ShapeKind) -> f64 {
    if shape == ShapeKind::CubicBspline { 3.0 } else { 4.0 }
}

/// The walls that reach a node, with their numbers.
fn walls_at<'a, const D: usize>(s: Setup<'a>, i: &[i64; D]) -> Vec<(usize, &'a Wall)> {
    let (o, walls) = s;
    let acts = |w: &&Wall| {
        let (d, side, end) = (w.axis, f64::from(w.side), usize::from(w.side < 0));
        let at = (w.position - o.origin[d]) / o.spacing;
        let between = between_walls::<D>(s)[d];
        match o.wall_treatment {
            WallTreatment::Plain => (i[d] as f64 - at) * side <= o.shape.wall_reach() + 1e-9,
            WallTreatment::Modified => {
                let innermost = (at - between.walls[end]).abs() < 1e-9;
                innermost && (i[d] - between.nodes[end]) as f64 * side <= 0.0
            }
        }
    };
    walls.iter().filter(acts).enumerate().collect()
}

/// A velocity of a node as the walls leave it, what they hold of it, and whether a sticky wall does
/// along itself.
pub fn walled<const D: usize>(
    s: Setup<'_>,
    i: &[i64; D],
    v: Vector<D>,
) -> (Vector<D>, Held, [bool; D]) {
    let (walls, mut v, mut sticks) = (walls_at(s, i), v.into(), [false; D]);
    let held = constrain(walls.iter().copied(), &mut v, &mut |n, a, _| {
        sticks[a] |= walls[n].1.kind == WallKind::Sticky && walls[n].1.axis != a;
    });
    (v.into(), held, sticks)
}

/// A velocity without what is held.
pub fn free<const D: usize>(held: Held, v: Vector<D>) -> Vector<D> {
    Vector::from_fn(|a, _| if held.has(a) { 0.0 } else { v[a] })
}

/// Masses, and what `give` gives to a node at the distance r, summed over the particles into
/// momenta and forces.
pub fn scatter<const D: usize>(
    s: Setup<'_>,
    particles: &[Particle<D>],
    v: impl Fn(usize, Vector<D>) -> Vector<D>,
) -> Grid<D> {
    let mut grid = Grid::new();
    for (k, p) in particles.iter().enumerate() {
        for (i, w, dw, r) in near(s, p) {
            let n = grid.entry(i).or_insert(Node(0.0, [Vector::zeros(); 6], Held::default()));
            n.0 += w * p.mass;
            n.1[MV] += w * p.mass * v(k, r);
            n.1[F] += w * p.mass * p.body_force - p.volume * p.stress * dw;
            n.1[F][0] -= if s.0.axisymmetric { p.volume * p.hoop_stress * w / p.x[0] } else { 0.0 };
        }
    }
    grid
}

/// Σ w v of the particles.
pub fn gather<const D: usize>(
    s: Setup<'_>,
    particles: &[Particle<D>],
    grid: &Grid<D>,
    field: usize,
) -> Vec<Vector<D>> {
    let sum = |p| near(s, p).iter().map(|(i, w, ..)| *w * grid[i].1[field]).sum();
    particles.iter().map(sum).collect()
}

/// A velocity gradient in three dimensions.
fn in_space<const D: usize>(l: &Matrix<D>, hoop: f64) -> Matrix3<f64> {
    let out_of_plane = |a, b| if D == 2 && (a, b) == (2, 2) { hoop } else { 0.0 };
    Matrix3::from_fn(|a, b| if a < D && b < D { l[(a, b)] } else { out_of_plane(a, b) })
}

/// The diagonal of U in F = R U.
fn stretch(f: &Matrix3<f64>) -> Vector3<f64> {
    let e = (f.transpose() * f).symmetric_eigen();
    let roots = Matrix3::from_diagonal(&e.eigenvalues.map(f64::sqrt));
    (e.eigenvectors * roots * e.eigenvectors.transpose()).diagonal()
}

/// Volumes and stresses over `dt` with the gradients of a field of the grid.
pub fn strain<const D: usize>(
    s: Setup<'_>,
    particles: &mut [Particle<D>],
    x: &[Vector<D>],
    (grid, field): (&Grid<D>, usize),
    dt: f64,
    update: &mut Update<'_, D>,
) {
    for (p, moved) in particles.iter_mut().zip(x) {
        let all = near(s, p);
        let l: Matrix<D> = all.iter().map(|(i, _, dw, _)| grid[i].1[field] * dw.transpose()).sum();
        let radial: f64 = all.iter().map(|(i, w, ..)| w * grid[i].1[field][0]).sum();
        let hoop = if s.0.axisymmetric { radial / p.x[0] } else { 0.0 };
        let mut growth = ((l.trace() + hoop) * dt).exp();
        if s.0.shape == ShapeKind::ContiguousGimp {
            let step = in_space(&l, hoop) * dt + Matrix3::identity();
            let (before, new) = (stretch(&p.f), step * p.f);
            p.size.iter_mut().enumerate().for_each(|(d, x)| *x *= stretch(&new)[d] / before[d]);
            (p.f, growth) = (new, step.determinant());
        }
        (p.x, p.volume) = (*moved, p.volume * growth);
        update(p, &l, hoop, dt);
    }
}
