//! Bodies from shapes: particles on a regular lattice.

use crate::error::{Error, Result};
use crate::memory::reserve;

/// A region to fill with particles. In two dimensions z is ignored, bodies are 1 m thick and a
/// sphere is a disc.
#[derive(Clone, Debug)]
pub enum Region {
    /// An axis-aligned box [m].
    Box {
        /// Lower corner.
        min: [f64; 3],
        /// Upper corner.
        max: [f64; 3],
    },
    /// A sphere or disc [m].
    Sphere {
        /// Centre.
        center: [f64; 3],
        /// Radius.
        radius: f64,
    },
    /// A simple polygon, in two dimensions only [m].
    Polygon {
        /// Corners in order, either way round.
        vertices: Vec<[f64; 2]>,
    },
}

/// How a region is filled.
#[derive(Clone, Copy, Debug)]
pub struct Fill {
    /// Particles per cell along each axis.
    pub particles_per_cell: i32,
    /// Density [kg/m³]; 0 if `mass` is given.
    pub density: f64,
    /// Mass of the whole body [kg]; 0 if `density` is given.
    pub mass: f64,
    /// Initial velocity [m/s].
    pub velocity: [f64; 3],
    /// Initial Cauchy stress [Pa], xx, yy, zz, xy, yz, zx.
    pub stress: [f64; 6],
}

impl Default for Fill {
    fn default() -> Self {
        Self {
            particles_per_cell: 2,
            density: 0.0,
            mass: 0.0,
            velocity: [0.0; 3],
            stress: [0.0; 6],
        }
    }
}

/// Most particles that one region may give.
const MOST: f64 = 4e9;

/// Positions of the particles of a region and the edge lengths of each.
///
/// A box is divided evenly, so its volume is exact; other regions take the points of a lattice
/// aligned with the grid that lie inside. The lattice has `per_cell` points a cell along each axis.
pub fn fill<const D: usize>(
    region: &Region,
    per_cell: i32,
    spacing: f64,
    origin: [f64; D],
) -> Result<(Vec<[f64; D]>, [f64; D])> {
    if !(1..=16).contains(&per_cell) {
        return Err(Error::invalid(format!(
            "particles_per_cell must be 1 to 16 along each axis, got {per_cell}"
        )));
    }
    let pitch = spacing / f64::from(per_cell);
    let (min, max) = bounds::<D>(region)?;
    let mut from = min;
    let mut pitches = [pitch; D];
    let mut count = [0i64; D];
    let mut all = 1.0;
    for d in 0..D {
        if let Region::Box { .. } = region {
            let n = ((max[d] - min[d]) / pitch).round().max(1.0);
            pitches[d] = (max[d] - min[d]) / n;
            count[d] = n as i64;
        } else {
            let first = ((min[d] - origin[d]) / pitch).floor();
            from[d] = origin[d] + first * pitch;
            count[d] = ((max[d] - from[d]) / pitch).ceil() as i64;
        }
        all *= count[d] as f64;
    }
    if !(all < MOST) {
        return Err(Error::invalid(format!(
            "the region would need {all:.3e} lattice points, more than {MOST:.0e}: use a larger spacing"
        )));
    }
    let mut points = Vec::new();
    reserve(&mut points, all as usize, "the points of a region")?;
    for flat in 0..count.iter().product::<i64>() {
        let mut rest = flat;
        let mut point = from;
        for d in (0..D).rev() {
            point[d] += ((rest % count[d]) as f64 + 0.5) * pitches[d];
            rest /= count[d];
        }
        if contains(region, &point) {
            points.push(point);
        }
    }
    if points.is_empty() {
        return Err(Error::invalid(format!(
            "the region holds no particle at {per_cell} a cell and spacing {spacing}: it is too small"
        )));
    }
    Ok((points, pitches))
}

fn bounds<const D: usize>(region: &Region) -> Result<([f64; D], [f64; D])> {
    let (min, max): ([f64; D], [f64; D]) = match region {
        Region::Box { min, max } => {
            (std::array::from_fn(|d| min[d]), std::array::from_fn(|d| max[d]))
        }
        Region::Sphere { center, radius } => {
            if !(*radius > 0.0 && radius.is_finite()) {
                return Err(Error::invalid(format!(
                    "radius must be positive and finite, got {radius}"
                )));
            }
            let at = |sign: f64| std::array::from_fn(|d| center[d] + sign * radius);
            (at(-1.0), at(1.0))
        }
        Region::Polygon { vertices } => {
            if D != 2 {
                return Err(Error::new(
                    crate::error::Status::Unsupported,
                    "a polygon fills a two-dimensional world; in three dimensions use a box or a sphere",
                ));
            }
            if vertices.len() < 3 {
                let n = vertices.len();
                return Err(Error::invalid(format!("a polygon needs 3 corners or more, got {n}")));
            }
            if let Some(v) = vertices.iter().find(|v| !(v[0].is_finite() && v[1].is_finite())) {
                return Err(Error::invalid(format!("corners must be finite [m], got {v:?}")));
            }
            let fold = |d: usize, start, f: fn(f64, f64) -> f64| {
                vertices.iter().fold(start, |m, v| f(m, v[d]))
            };
            (
                std::array::from_fn(|d| fold(d, f64::INFINITY, f64::min)),
                std::array::from_fn(|d| fold(d, f64::NEG_INFINITY, f64::max)),
            )
        }
    };
    if let Region::Polygon { vertices } = region {
        let (area, extent) = (area(vertices), (max[0] - min[0]) * (max[1] - min[1]));
        if !(area > 1e-9 * extent) {
            return Err(Error::invalid(format!(
                "the corners of the polygon must enclose an area, got {area:e} m^2: give them in order round the shape"
            )));
        }
    }
    for d in 0..D {
        if !(min[d].is_finite() && max[d].is_finite() && min[d] < max[d]) {
            let (axis, low, high) = (["x", "y", "z"][d], min[d], max[d]);
            return Err(Error::invalid(format!(
                "the region must have a finite, positive extent; along {axis} it goes from {low:e} to {high:e}"
            )));
        }
    }
    Ok((min, max))
}

/// Area inside a polygon [m²]; what is run round in opposite senses cancels.
fn area(vertices: &[[f64; 2]]) -> f64 {
    let last = vertices[vertices.len() - 1];
    let twice = vertices.iter().fold((last, 0.0), |(a, sum), b| {
        (*b, sum + (a[0] - last[0]) * (b[1] - last[1]) - (b[0] - last[0]) * (a[1] - last[1]))
    });
    0.5 * f64::abs(twice.1)
}

fn contains<const D: usize>(region: &Region, x: &[f64; D]) -> bool {
    match region {
        Region::Box { .. } => true,
        Region::Sphere { center, radius } => {
            (0..D).map(|d| (x[d] - center[d]).powi(2)).sum::<f64>() <= radius * radius
        }
        Region::Polygon { vertices } => {
            let mut inside = false;
            let mut a = vertices[vertices.len() - 1];
            for b in vertices {
                if (a[1] > x[1]) != (b[1] > x[1])
                    && x[0] < a[0] + (x[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
                {
                    inside = !inside;
                }
                a = *b;
            }
            inside
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_keeps_its_volume_whatever_the_spacing() {
        let region = Region::Box { min: [0.1, 0.2, 0.0], max: [1.35, 0.93, 0.0] };
        let (points, [a, b]) = fill::<2>(&region, 2, 0.1, [0.0, 0.0]).expect("a good box");
        assert!((points.len() as f64 * a * b - 1.25 * 0.73).abs() < 1e-12);
    }

    #[test]
    fn a_polygon_holds_the_points_inside_it() {
        let vertices = vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
        let (points, [a, b]) =
            fill::<2>(&Region::Polygon { vertices }, 2, 0.5, [0.0, 0.0]).expect("a good triangle");
        assert!(points.iter().all(|x| x[0] + x[1] < 4.0));
        assert!((points.len() as f64 * a * b - 8.0).abs() < 0.6);
    }

    #[test]
    fn a_region_without_extent_is_refused() {
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let region = Region::Sphere { center: [0.0; 3], radius };
            assert!(fill::<3>(&region, 2, 1.0, [0.0; 3]).is_err());
        }
        let flat = Region::Box { min: [0.0; 3], max: [1.0, 0.0, 1.0] };
        assert!(fill::<3>(&flat, 2, 1.0, [0.0; 3]).expect_err("flat").message.contains("along y"));
    }
}
