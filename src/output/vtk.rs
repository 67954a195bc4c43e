//! VTP files (XML poly data, zlib-compressed) for ParaView and the like.
//!
//! A file is written block by block, so that it needs little memory beside the particles.

use std::ffi::CStr;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use flate2::{Compress, Compression, FlushCompress, Status as Flate};

use crate::error::{Error, Result, Status};
use crate::memory::{ensure, reserve, reserve_exact};
use crate::world::World;
use crate::world::fields::FieldSlice;

/// What memory is for, if there is none.
const WHAT: &str = "the arrays of a VTP file";

/// Bytes that are compressed at a time.
const BLOCK: usize = 1 << 15;

/// More than zlib needs for itself [bytes].
const COMPRESSOR: usize = 1 << 20;

/// Writes the particles of all bodies with every field of the registry, the id of the body and the
/// id of the particle. Points are in the order of bodies and ids, so that frames can be subtracted,
/// and the time is the field data `TimeValue` [s]. Vectors get three components; of a state
/// variable that a body does not have the values are NaN. A file of that name is replaced as a
/// whole.
pub fn write(world: &World, path: &Path) -> Result<()> {
    if path.extension().and_then(|e| e.to_str()) != Some("vtp") {
        return Err(Error::invalid(format!("a VTP file ends in .vtp, got `{}`", path.display())));
    }
    let frame = Frame::new(world)?;
    let blocks = (9 * frame.count * size_of::<f64>()).div_ceil(BLOCK);
    let encoder = Encoder::new(blocks)?;
    // written under another name first, so that an old file stays whole if the disk is full
    let aside = path.with_extension("vtp.part");
    let written = File::create(&aside)
        .and_then(|file| frame.write(&mut Writer { file: BufWriter::new(file), encoder }))
        .and_then(|()| std::fs::rename(&aside, path));
    written.map_err(|why| {
        let _ = std::fs::remove_file(&aside); // it may not exist
        let path = path.display();
        let text = format!("cannot write `{path}`: {why}; check folder, rights and space");
        Error::new(Status::File, text)
    })
}

/// What a file holds.
struct Frame<'a> {
    world: &'a World,
    /// The arrays beside position and ids, in the order of their names.
    arrays: Vec<Array>,
    /// For each body and each id the place of the particle in storage.
    places: Vec<u32>,
    count: usize,
}

/// An array of points.
struct Array {
    name: &'static CStr,
    /// Components in the file.
    components: usize,
    /// Whether there is another array of this name and of another shape.
    renamed: bool,
}

impl<'a> Frame<'a> {
    fn new(world: &'a World) -> Result<Self> {
        let (mut arrays, mut places) = (Vec::<Array>::new(), Vec::new());
        for body in bodies(world) {
            for info in world.fields(body)? {
                let (name, components) = (info.name, in_space(world, info.components));
                let mut same = arrays.iter().filter(|array| array.name == name).peekable();
                // state variables of different models may share a name but not a shape
                let renamed = same.peek().is_some();
                if name != c"position" && same.all(|array| array.components != components) {
                    reserve(&mut arrays, 1, WHAT)?;
                    arrays.push(Array { name, components, renamed });
                }
            }
            let (first, ids) = (places.len(), world.ids(body)?);
            reserve(&mut places, ids.len(), WHAT)?;
            places.resize(first + ids.len(), 0);
            for (place, id) in ids.iter().enumerate() {
                places[first + *id as usize] = place as u32;
            }
        }
        arrays.sort_unstable_by_key(|array| (array.name, array.renamed, array.components));
        let count = places.len();
        Ok(Self { world, arrays, places, count })
    }

    fn write(&self, out: &mut Writer) -> io::Result<()> {
        let (n, time) = (self.count, self.world.time());
        writeln!(
            out.file,
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n\
             <FieldData><DataArray Name=\"TimeValue\" type=\"Float64\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time:e}</DataArray></FieldData>\n\
             <Piece NumberOfPoints=\"{n}\" NumberOfVerts=\"{n}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"0\">\n<PointData>"
        )?;
        let of_bodies = || bodies(self.world).map(|body| (body, self.size(body)));
        let body = of_bodies().flat_map(|(body, size)| (0..size).map(move |_| body));
        out.integers("body", n, body)?;
        out.integers("id", n, of_bodies().flat_map(|(_, size)| 0..size))?;
        for Array { name, components, renamed } in &self.arrays {
            let text = name.to_string_lossy();
            match renamed {
                true => self.array(out, &format!("{text}_{components}"), name, *components)?,
                false => self.array(out, &text, name, *components)?,
            }
        }
        out.file.write_all(b"</PointData>\n<Points>\n")?;
        self.array(out, "Points", c"position", 3)?;
        out.file.write_all(b"</Points>\n<Verts>\n")?;
        out.integers("connectivity", n, 0..n as i64)?;
        out.integers("offsets", n, 1..=n as i64)?;
        out.file.write_all(b"</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n")?;
        out.file.flush()
    }

    /// Writes a field of all bodies under a name.
    fn array(
        &self,
        out: &mut Writer,
        name: &str,
        field: &CStr,
        components: usize,
    ) -> io::Result<()> {
        let mut first = 0;
        let values = bodies(self.world).flat_map(move |body| {
            let places = &self.places[first..first + self.size(body) as usize];
            first += places.len();
            let found = field.to_str().ok().and_then(|f| self.world.field_data(body, f).ok());
            let slice = found.filter(|s| in_space(self.world, s.components) == components);
            places.iter().flat_map(move |place| {
                (0..components).map(move |c| slice.map_or(f64::NAN, |s| value(&s, c, *place)))
            })
        });
        let bytes = values.map(f64::to_le_bytes);
        out.array((name, "Float64", components), self.count * components, bytes)
    }

    fn size(&self, body: i64) -> i64 {
        self.world.particle_count(body).unwrap_or(0) as i64
    }
}

fn bodies(world: &World) -> impl Iterator<Item = i64> {
    (0..world.body_count()).map(|place| world.body_id(place))
}

/// Components in the file: vectors of a plane become vectors of space, for ParaView.
fn in_space(world: &World, components: usize) -> usize {
    if components == world.options().dimension { 3 } else { components }
}

fn value(slice: &FieldSlice<'_>, c: usize, place: u32) -> f64 {
    if c < slice.components { slice.data[c * slice.stride + place as usize] } else { 0.0 }
}

/// A file to which arrays are written.
struct Writer {
    file: BufWriter<File>,
    encoder: Encoder,
}

/// What compresses, with its buffers.
struct Encoder {
    zlib: Compress,
    block: Vec<u8>,
    packed: Vec<u8>,
    /// Compressed sizes of the blocks of an array, behind the three numbers of its header.
    header: Vec<u64>,
}

impl Encoder {
    /// For arrays of so many blocks.
    fn new(blocks: usize) -> Result<Self> {
        let (mut block, mut packed, mut header) = (Vec::new(), Vec::new(), Vec::new());
        reserve_exact(&mut block, BLOCK, WHAT)?;
        reserve_exact(&mut packed, BLOCK + BLOCK / 8, WHAT)?; // what cannot be compressed grows a little
        reserve_exact(&mut header, 3 + blocks, WHAT)?;
        ensure(COMPRESSOR, "the compression of VTP files")?;
        Ok(Self { zlib: Compress::new(Compression::fast(), true), block, packed, header })
    }
}

impl Writer {
    fn integers(
        &mut self,
        name: &str,
        count: usize,
        values: impl Iterator<Item = i64>,
    ) -> io::Result<()> {
        self.array((name, "Int64", 1), count, values.map(i64::to_le_bytes))
    }

    /// Writes an array of `count` values: a header with the sizes of its compressed blocks, then
    /// the blocks, both in base 64.
    fn array(
        &mut self,
        (name, kind, components): (&str, &str, usize),
        count: usize,
        values: impl Iterator<Item = [u8; 8]>,
    ) -> io::Result<()> {
        let Self { file, encoder: Encoder { zlib, block, packed, header } } = self;
        write!(
            file,
            "<DataArray Name=\"{name}\" type=\"{kind}\" NumberOfComponents=\"{components}\" format=\"binary\">"
        )?;
        let start = file.stream_position()?;
        let (whole, rest) = (count * 8 / BLOCK, count * 8 % BLOCK);
        let blocks = whole + usize::from(rest > 0);
        header.clear();
        header.extend([blocks as u64, BLOCK as u64, rest as u64]);
        let mut base64 = Base64::default();
        base64.zeros(file, (3 + blocks) * 8)?; // sizes that are not known yet
        let mut values = values.peekable();
        while values.peek().is_some() {
            block.clear();
            block.extend(values.by_ref().take(BLOCK / 8).flatten());
            packed.clear();
            zlib.reset();
            let done = zlib.compress_vec(block, packed, FlushCompress::Finish)?;
            if done != Flate::StreamEnd {
                return Err(io::Error::other("zlib does not finish a block"));
            }
            header.push(packed.len() as u64);
            base64.write(file, packed)?;
        }
        base64.end(file)?;
        let end = file.stream_position()?;
        file.seek(SeekFrom::Start(start))?;
        for number in &*header {
            base64.write(file, &number.to_le_bytes())?;
        }
        base64.end(file)?;
        file.seek(SeekFrom::Start(end))?;
        file.write_all(b"</DataArray>\n")
    }
}

/// Bytes on their way into base 64 that do not fill three yet.
#[derive(Default)]
struct Base64 {
    waiting: [u8; 3],
    count: usize,
}

impl Base64 {
    fn write(&mut self, file: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
        for byte in bytes {
            self.waiting[self.count] = *byte;
            self.count += 1;
            if self.count == 3 {
                self.end(file)?;
            }
        }
        Ok(())
    }

    fn zeros(&mut self, file: &mut impl Write, count: usize) -> io::Result<()> {
        (0..count).try_for_each(|_| self.write(file, &[0]))?;
        self.end(file)
    }

    /// Writes what is waiting; it is filled up with `=`.
    fn end(&mut self, file: &mut impl Write) -> io::Result<()> {
        const LETTERS: &[u8; 64] =
            b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        if self.count == 0 {
            return Ok(());
        }
        let [a, b, c] = self.waiting;
        let bits = u32::from_be_bytes([0, a, b, c]);
        let mut letters = [18, 12, 6, 0].map(|shift| LETTERS[(bits >> shift) as usize % 64]);
        letters[self.count + 1..].fill(b'=');
        *self = Self::default();
        file.write_all(&letters)
    }
}
