//! Arrays of the host: doubles with a stride between components and one between points.

use crate::error::{Error, Result};

/// Layout of the components of points in a flat array.
#[derive(Clone, Copy, Debug)]
pub struct Strides {
    /// Number of points.
    pub count: usize,
    /// Components per point.
    pub components: usize,
    /// Distance between components of a point.
    pub component: usize,
    /// Distance between points.
    pub point: usize,
}

impl Strides {
    /// Checks strides given by a host. Both zero means interleaved: point after point.
    pub fn new(count: usize, components: usize, component: i64, point: i64) -> Result<Self> {
        let interleaved = component == 0 && point == 0;
        let (component, point) =
            if interleaved { (1, components as i64) } else { (component, point) };
        let overlap =
            "component_stride and point_stride must be positive (or both 0: point after point)";
        if component < 1 || point < 1 {
            return Err(Error::invalid(format!("{overlap}, got {component} and {point}")));
        }
        let last = (count.max(1) as i64 - 1)
            .checked_mul(point)
            .and_then(|p| p.checked_add((components.max(1) as i64 - 1).checked_mul(component)?));
        if last.is_none_or(|last| last > isize::MAX as i64 / 8 - 1) {
            return Err(Error::invalid(format!(
                "{count} points with strides {component} and {point} do not fit the address space"
            )));
        }
        Ok(Self { count, components, component: component as usize, point: point as usize })
    }

    /// Doubles that the array must have.
    pub fn needed(&self) -> usize {
        if self.count == 0 || self.components == 0 {
            return 0;
        }
        (self.count - 1) * self.point + (self.components - 1) * self.component + 1
    }

    /// Index of component c of point k.
    #[inline(always)]
    pub fn at(&self, c: usize, k: usize) -> usize {
        c * self.component + k * self.point
    }
}

/// An array of the host to read.
#[derive(Clone, Copy, Debug)]
pub struct Strided<'a> {
    /// The doubles.
    pub data: &'a [f64],
    /// Where the points are.
    pub strides: Strides,
}

impl<'a> Strided<'a> {
    /// `count` points of `components` in `data`.
    pub fn new(data: &'a [f64], strides: Strides) -> Result<Self> {
        check_length(data.len(), &strides)?;
        Ok(Self { data, strides })
    }

    /// Points one after the other.
    pub fn interleaved(data: &'a [f64], components: usize) -> Result<Self> {
        Self::new(data, Strides::new(data.len() / components, components, 0, 0)?)
    }

    /// The same components for each of `count` points.
    pub fn constant(data: &'a [f64], count: usize) -> Self {
        let strides = Strides { count, components: data.len(), component: 1, point: 0 };
        Self { data, strides }
    }

    /// Component c of point k.
    #[inline(always)]
    pub fn get(&self, c: usize, k: usize) -> f64 {
        self.data[self.strides.at(c, k)]
    }
}

/// An array of the host to write.
#[derive(Debug)]
pub struct StridedMut<'a> {
    /// The doubles.
    pub data: &'a mut [f64],
    /// Where the points are.
    pub strides: Strides,
}

impl<'a> StridedMut<'a> {
    /// `count` points of `components` in `data`.
    pub fn new(data: &'a mut [f64], strides: Strides) -> Result<Self> {
        check_length(data.len(), &strides)?;
        Ok(Self { data, strides })
    }
}

fn check_length(len: usize, strides: &Strides) -> Result<()> {
    if len >= strides.needed() {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "{} points of {} components need {} doubles, the array has {len}",
        strides.count,
        strides.components,
        strides.needed()
    )))
}

/// Particles of a new body.
#[derive(Clone, Copy, Debug)]
pub struct ParticleArrays<'a> {
    /// Positions [m], D components.
    pub position: Strided<'a>,
    /// Volumes [m³].
    pub volume: Strided<'a>,
    /// Masses [kg]; None: `density` times volume.
    pub mass: Option<Strided<'a>>,
    /// Density [kg/m³]; used without masses, else 0.
    pub density: f64,
    /// Velocities [m/s], D components; None: at rest.
    pub velocity: Option<Strided<'a>>,
    /// Cauchy stresses [Pa], 6 components; None: no stress.
    pub stress: Option<Strided<'a>>,
    /// Edge lengths of the particles' domains [m], D components; None: not known.
    pub size: Option<Strided<'a>>,
}
