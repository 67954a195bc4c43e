//! The step as the textbook writes it: the oracle of every fast kernel. No blocks, no tiles, no
//! threads.

pub mod nodes;

use crate::shape::ShapeKind;
use crate::step::StepOrder;
use crate::transfer::{TransferKind, pic_flip::pic_share};
use nodes::{
    DV, F, Grid, LAST, MV, Matrix, Near, Particle, Setup, U, Update, V, Vector, free, gather,
    is_modified, moment, near, scatter, strain, walled,
};

/// One step of length `dt` [s]; `update` gets each particle with its velocity gradient [1/s] and
/// the time over which it holds.
pub fn step<const D: usize>(
    s: Setup<'_>,
    particles: &mut [Particle<D>],
    dt: f64,
    update: &mut Update<'_, D>,
) {
    let (o, g) = (s.0, Vector::<D>::from_fn(|a, _| s.0.gravity[a]));
    let first = match o.order {
        StepOrder::Usf => 1.0,
        StepOrder::Usavg => 0.5,
        _ => 0.0,
    };
    let affine = |ps: &[Particle<D>]| {
        let ps = ps.to_vec();
        move |k: usize, r| ps[k].v + ps[k].c * r
    };
    if first > 0.0 {
        let mut grid = scatter(s, particles, affine(particles));
        for (i, n) in &mut grid {
            n.2 = walled(s, i, n.1[MV] / n.0 + dt * (n.1[F] / n.0 + g)).1;
            n.1[V] = free(n.2, n.1[MV] / n.0);
        }
        filter_field(s, particles, &mut grid, V);
        let x: Vec<_> = particles.iter().map(|p| p.x).collect();
        strain(s, particles, &x, (&grid, V), first * dt, update);
    }
    let mut grid = scatter(s, particles, affine(particles));
    for (i, n) in &mut grid {
        let old = n.1[MV] / n.0;
        let (new, held, sticks) = walled(s, i, old + dt * (n.1[F] / n.0 + g));
        let still = |a: usize| o.transfer == TransferKind::PicFlip && sticks[a];
        let change = Vector::<D>::from_fn(|a, _| if still(a) { 0.0 } else { new[a] - old[a] });
        let damping = free(held, change.zip_map(&old, |dv, v| o.damping * dv.abs() * v.signum()));
        (n.1[V], n.1[DV], n.2) = (new - damping, change - damping, held);
    }
    if o.transfer.is_filtered() {
        filter_grid(s, particles, &mut grid);
    }
    let [pic, flip, u] = [V, DV, U].map(|field| gather(s, particles, &grid, field));
    let share = pic_share(o.pic_rate, dt);
    let x: Vec<_> = particles.iter().zip(&pic).map(|(p, v)| p.x + dt * v).collect();
    for (k, p) in particles.iter_mut().enumerate() {
        let whole = near(s, p);
        let modified = |d: usize| is_modified(s, p, d);
        let splines = matches!(o.shape, ShapeKind::QuadraticBspline | ShapeKind::CubicBspline);
        let apic = |d: usize| splines && o.transfer != TransferKind::Tpic && !modified(d);
        let column = |(i, w, dw, r): &Near<D>| {
            let by = Vector::<D>::from_fn(|d, _| {
                if apic(d) { r[d] * w * moment(o.shape) / o.spacing.powi(2) } else { dw[d] }
            });
            grid[i].1[V] * by.transpose()
        };
        let c = whole.iter().map(column).sum();
        p.v = match o.transfer {
            TransferKind::PicFlip => (1.0 - share) * (p.v + flip[k]) + share * pic[k],
            TransferKind::Xpic | TransferKind::Fmpm => u[k],
            _ => pic[k],
        };
        p.c = if o.transfer.is_affine() { c } else { Matrix::zeros() };
    }
    if o.order == StepOrder::Musl {
        let again = scatter(s, particles, affine(particles));
        grid.iter_mut().for_each(|(i, n)| n.1[LAST] = free(n.2, again[i].1[MV] / n.0));
        filter_field(s, particles, &mut grid, LAST);
    }
    match o.order {
        StepOrder::Usf => particles.iter_mut().zip(&x).for_each(|(p, x)| p.x = *x),
        StepOrder::Musl => strain(s, particles, &x, (&grid, LAST), dt, update),
        _ => strain(s, particles, &x, (&grid, V), (1.0 - first) * dt, update),
    }
}

/// The velocities that particles take in XPIC and FMPM; in the latter they are those of the grid
/// too.
fn filter_grid<const D: usize>(s: Setup<'_>, particles: &[Particle<D>], grid: &mut Grid<D>) {
    let xpic = s.0.transfer == TransferKind::Xpic;
    for n in grid.values_mut() {
        n.1[LAST] = n.1[V] - if xpic { n.1[DV] } else { Vector::zeros() };
    }
    sum_terms(s, particles, grid, LAST);
    for n in grid.values_mut() {
        n.1[U] = free(n.2, n.1[U] + n.1[V] - n.1[LAST]);
        n.1[V] = if xpic { n.1[V] } else { n.1[U] };
    }
}

/// A field that came from the particles, filtered if the transfer is.
fn filter_field<const D: usize>(s: Setup<'_>, ps: &[Particle<D>], grid: &mut Grid<D>, f: usize) {
    if s.0.transfer.is_filtered() {
        sum_terms(s, ps, grid, f);
        grid.values_mut().for_each(|n| n.1[f] = n.1[U]);
    }
}

/// The terms of the filter that begin with a field, summed into U.
fn sum_terms<const D: usize>(s: Setup<'_>, ps: &[Particle<D>], grid: &mut Grid<D>, start: usize) {
    grid.values_mut().for_each(|n| n.1[U] = free(n.2, n.1[start]));
    for _ in 1..s.0.filter_order {
        let u = gather(s, ps, grid, U);
        let again = scatter(s, ps, |k, _| u[k]);
        for (i, n) in grid.iter_mut() {
            n.1[U] = free(n.2, n.1[U] + n.1[start] - again[i].1[MV] / n.0);
        }
    }
}
