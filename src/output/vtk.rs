//! VTP files (XML poly data, zlib-compressed) for ParaView and the like.

use std::collections::BTreeMap;
use std::path::Path;

use vtkio::model::{
    Attribute, Attributes, ByteOrder, DataSet, PolyDataPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

use crate::error::{Error, Result, Status};
use crate::world::World;

/// Compression level: fast.
const LEVEL: u32 = 1;

/// Writes the particles of all bodies with every field of the registry, the id of the body and the
/// id of the particle. Vectors get three components; of a state variable that a body does not have
/// the values are NaN. A file of that name is replaced as a whole.
pub fn write(world: &World, path: &Path) -> Result<()> {
    let failed = |what: String| {
        let path = path.display();
        Error::new(
            Status::File,
            format!("cannot write `{path}`: {what}; check folder, rights and space"),
        )
    };
    if path.extension().and_then(|e| e.to_str()) != Some("vtp") {
        return Err(Error::invalid(format!("a VTP file ends in .vtp, got `{}`", path.display())));
    }
    let file = vtk(world)?
        .try_into_xml_format(Compressor::ZLib, LEVEL)
        .map_err(|error| failed(error.to_string()))?;
    let mut bytes = Vec::new();
    file.write(&mut bytes).map_err(|error| failed(error.to_string()))?;
    // written under another name first, so that an old file stays whole if the disk is full
    let aside = path.with_extension("vtp.part");
    let written = std::fs::write(&aside, bytes).and_then(|()| std::fs::rename(&aside, path));
    written.map_err(|error| {
        let _ = std::fs::remove_file(&aside); // it may not exist
        failed(error.to_string())
    })
}

fn vtk(world: &World) -> Result<Vtk> {
    let dimension = world.options().dimension;
    let bodies = world.bodies();
    let mut count = 0;
    let mut arrays: BTreeMap<String, (usize, Vec<f64>)> = BTreeMap::new();
    let (mut body_id, mut particle_id) = (Vec::new(), Vec::new());
    for &body in &bodies {
        let n = world.particle_count(body)?;
        for info in world.fields(body)? {
            let name = info.name.to_string_lossy().into_owned();
            let slice = world.field_data(body, &name)?;
            // vectors of a plane become vectors of space, for ParaView
            let components = if slice.components == dimension { 3 } else { slice.components };
            // state variables of different models may share a name but not a shape
            let name = match arrays.get(&name) {
                Some((width, _)) if *width != components => format!("{name}_{components}"),
                _ => name,
            };
            let array = arrays.entry(name).or_insert((components, Vec::new()));
            array.1.resize(count * components, f64::NAN);
            for k in 0..n {
                let value =
                    |c| if c < slice.components { slice.data[c * slice.stride + k] } else { 0.0 };
                array.1.extend((0..components).map(value));
            }
        }
        body_id.resize(count + n, body);
        particle_id.extend_from_slice(world.ids(body)?);
        count += n;
    }
    let (_, points) = arrays.remove("position").unwrap_or_default();
    let mut point = vec![
        Attribute::scalars("body", 1).with_data(body_id),
        Attribute::scalars("id", 1).with_data(particle_id),
    ];
    for (name, (components, mut data)) in arrays {
        data.resize(count * components, f64::NAN);
        let array = match components {
            3 => Attribute::vectors(name),
            n => Attribute::generic(name, n as u32),
        };
        point.push(array.with_data(data));
    }
    Ok(Vtk {
        version: Version::new_xml(1, 0),
        byte_order: ByteOrder::LittleEndian,
        title: format!("lahar, t = {} s", world.time()),
        file_path: None,
        data: DataSet::inline(PolyDataPiece {
            points: points.into(),
            verts: Some(VertexNumbers::XML {
                connectivity: (0..count as u64).collect(),
                offsets: (1..=count as u64).collect(),
            }),
            data: Attributes { point, cell: Vec::new() },
            ..PolyDataPiece::default()
        }),
    })
}
