//! Access to particle fields by name.

use crate::error::{Error, Result, Status};
use crate::memory::reserve;
use crate::particles::{Body, FieldInfo};
use crate::step::parts::Parts;

use super::host_arrays::{Strided, StridedMut};
use super::{World, on};

/// A field in storage order: component c of particle k at `data[c * stride + k]`.
#[derive(Clone, Copy, Debug)]
pub struct FieldSlice<'a> {
    /// The doubles, with the padding between components.
    pub data: &'a [f64],
    /// Number of particles.
    pub count: usize,
    /// Number of components.
    pub components: usize,
    /// Distance between components.
    pub stride: usize,
}

/// A field in storage order, to write.
#[derive(Debug)]
pub struct FieldSliceMut<'a> {
    /// The doubles, with the padding between components.
    pub data: &'a mut [f64],
    /// Ids of the particles in storage order.
    pub ids: &'a [i64],
    /// Number of particles.
    pub count: usize,
    /// Number of components.
    pub components: usize,
    /// Distance between components.
    pub stride: usize,
}

/// The fields of a body with their first columns: those of the engine, then the state variables of
/// the model.
fn fields_of(body: &Body, dimension: usize) -> impl Iterator<Item = (FieldInfo, usize)> + Clone {
    let layout = &body.particles.layout;
    let mut first = layout.state.first;
    let states = body.material.model().states.iter().map(move |state| {
        let components = state.kind.components();
        first += components;
        let info = FieldInfo {
            name: state.key_c,
            unit: state.unit_c,
            description: state.description_c,
            components,
            writable: true,
        };
        (info, first - components)
    });
    layout.fields(dimension).into_iter().chain(states)
}

fn find<const D: usize>(state: &Parts<D>, body: i64, name: &str) -> Result<(FieldInfo, usize)> {
    let body = state.body(body)?;
    let found = fields_of(body, D).find(|(info, _)| info.name.to_bytes() == name.as_bytes());
    found.ok_or_else(|| {
        let names = fields_of(body, D).filter_map(|(info, _)| info.name.to_str().ok());
        Error::unknown_name("particle field", name, names)
    })
}

impl World {
    /// The fields of a body.
    pub fn fields(&self, body: i64) -> Result<Vec<FieldInfo>> {
        on!(&self, s => {
            let body = s.body(body)?;
            let mut fields = Vec::new();
            for (info, _) in fields_of(body, s.method.options.dimension) {
                reserve(&mut fields, 1, "the fields of a body")?;
                fields.push(info);
            }
            Ok(fields)
        })
    }

    /// The field of a body with this name.
    pub fn field_info(&self, body: i64, name: &str) -> Result<FieldInfo> {
        on!(&self, s => Ok(find(s, body, name)?.0))
    }

    /// A field in storage order.
    pub fn field_data(&self, body: i64, field: &str) -> Result<FieldSlice<'_>> {
        on!(&self, s => {
            let (info, first) = find(s, body, field)?;
            let particles = &s.body(body)?.particles;
            Ok(FieldSlice {
                data: particles.columns(first, info.components),
                count: particles.len(),
                components: info.components,
                stride: particles.stride(),
            })
        })
    }

    /// A field in storage order, to write. What is written is checked before the next step.
    pub fn field_data_mut(&mut self, body: i64, field: &str) -> Result<FieldSliceMut<'_>> {
        self.field_view_mut(body, field)?;
        self.views_closed();
        self.field_view_mut(body, field)
    }

    /// The same for a caller that writes later and then calls [`World::views_closed`].
    pub fn field_view_mut(&mut self, body: i64, field: &str) -> Result<FieldSliceMut<'_>> {
        self.check_alive()?;
        let info = self.field_info(body, field)?;
        if !info.writable {
            let text = format!("the field `{field}` can be read but not written");
            return Err(Error::new(Status::ReadOnly, text));
        }
        on!(&mut self, s => {
            s.freshness.field_opened(field);
            let (info, first) = find(s, body, field)?;
            let at = s.body_position(body)?;
            s.bodies[at].stress_given |= field == "stress";
            let particles = &mut s.bodies[at].particles;
            let (count, stride) = (particles.len(), particles.stride());
            let (ids, data) = particles.ids_and_columns_mut(first, info.components);
            Ok(FieldSliceMut { data, ids, count, components: info.components, stride })
        })
    }

    /// Ids of the particles in storage order.
    pub fn ids(&self, body: i64) -> Result<&[i64]> {
        on!(&self, s => Ok(&s.body(body)?.particles.id[..]))
    }

    /// Copies a field, by id: point k of the array is the particle with id k.
    pub fn read_field(&self, body: i64, field: &str, out: &mut StridedMut<'_>) -> Result<()> {
        let slice = self.field_data(body, field)?;
        check_shape(field, &slice, out.strides.count, out.strides.components)?;
        for (k, id) in self.ids(body)?.iter().enumerate() {
            for c in 0..slice.components {
                out.data[out.strides.at(c, *id as usize)] = slice.data[c * slice.stride + k];
            }
        }
        Ok(())
    }

    /// Sets a field, by id. On error nothing changes; values must be finite.
    pub fn write_field(&mut self, body: i64, field: &str, data: &Strided<'_>) -> Result<()> {
        let slice = self.field_data(body, field)?;
        check_shape(field, &slice, data.strides.count, data.strides.components)?;
        for k in 0..slice.count {
            for c in 0..slice.components {
                let value = data.get(c, k);
                if !value.is_finite() {
                    return Err(Error::invalid(format!(
                        "{field} of particle {k} must be finite, got {value} in component {c}"
                    )));
                }
            }
        }
        let slice = self.field_data_mut(body, field)?;
        for (k, id) in slice.ids.iter().enumerate() {
            for c in 0..slice.components {
                slice.data[c * slice.stride + k] = data.get(c, *id as usize);
            }
        }
        Ok(())
    }
}

fn check_shape(field: &str, slice: &FieldSlice<'_>, count: usize, components: usize) -> Result<()> {
    if (count, components) == (slice.count, slice.components) {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "the field `{field}` has {} components of {} particles, the array {components} of {count}",
        slice.components, slice.count
    )))
}
