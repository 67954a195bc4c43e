//! From raw C arguments to checked Rust values. The contract of every function here: a pointer is
//! NULL, or it points to memory of the host that is valid for the described type until the exported
//! function returns.

use crate::error::{Error, Result, Status};
use crate::world::host_arrays::Strides;
use std::ffi::{CStr, CString, c_char};
use std::mem::MaybeUninit;
use std::ptr::NonNull;

/// Largest `struct_size` that is accepted; a larger one is an uninitialised field.
const LARGEST_STRUCT: usize = 4096;

pub(super) fn null(name: &str) -> Error {
    Error::new(Status::NullArgument, format!("`{name}` is NULL; expected a valid pointer"))
}

fn check<T>(pointer: *const T, name: &str) -> Result<()> {
    if pointer.is_null() {
        return Err(null(name));
    }
    if !pointer.is_aligned() {
        let bytes = align_of::<T>();
        let text = format!("`{name}` is not aligned to {bytes} bytes; expected a valid pointer");
        return Err(Error::new(Status::NullArgument, text));
    }
    Ok(())
}

/// A variable of the host to write one value to.
pub(super) struct Out<T>(NonNull<T>);

impl<T: Copy> Out<T> {
    /// Writes the value.
    pub(super) fn set(&self, value: T) {
        // SAFETY: `out` checked for NULL and alignment, and by contract of its caller the memory
        // may be written.
        unsafe { self.0.as_ptr().write(value) };
    }
}

/// A mandatory output.
pub(super) unsafe fn out<T>(pointer: *mut T, name: &str) -> Result<Out<T>> {
    check(pointer, name)?;
    NonNull::new(pointer).map(Out).ok_or_else(|| null(name))
}

/// An output that may be NULL.
pub(super) unsafe fn optional_out<T>(pointer: *mut T, name: &str) -> Result<Option<Out<T>>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the contract of this function is that of `out`.
    unsafe { out(pointer, name) }.map(Some)
}

/// The variable for a new handle, set to NULL.
pub(super) unsafe fn handle_out<T>(pointer: *mut *mut T, name: &str) -> Result<Out<*mut T>> {
    // SAFETY: the contract of this function is that of `out`.
    let target = unsafe { out(pointer, name) }?;
    target.set(std::ptr::null_mut());
    Ok(target)
}

/// The object behind a handle or a pointer to a plain struct.
pub(super) unsafe fn reference<'a, T>(pointer: *const T, name: &str) -> Result<&'a T> {
    check(pointer, name)?;
    // SAFETY: not NULL, aligned, and by contract valid until the exported function returns.
    Ok(unsafe { &*pointer })
}

/// Longest text that is accepted [bytes]: that of a path.
const LONGEST_TEXT: usize = 4096;

/// A NUL-terminated text in UTF-8.
pub(super) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str> {
    check(pointer, name)?;
    // SAFETY: not NULL, and by contract NUL-terminated.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    if bytes.count_bytes() > LONGEST_TEXT {
        return Err(Error::invalid(format!(
            "`{name}` has {} bytes; expected {LONGEST_TEXT} at most",
            bytes.count_bytes()
        )));
    }
    bytes.to_str().map_err(|why| {
        let valid = String::from_utf8_lossy(&bytes.to_bytes()[..why.valid_up_to()]);
        Error::invalid(format!("`{name}` is not UTF-8 after `{valid}`"))
    })
}

/// A count as a usize; negative counts are refused.
pub(super) fn count(value: i64, name: &str) -> Result<usize> {
    usize::try_from(value)
        .map_err(|_| Error::invalid(format!("`{name}` is {value}; expected 0 or more")))
}

/// The index of an item in a list of `length`.
pub(super) fn index(value: i64, length: usize, name: &str) -> Result<usize> {
    usize::try_from(value).ok().filter(|i| *i < length).ok_or_else(|| {
        Error::new(
            Status::NotFound,
            format!("`{name}` is {value}; there are {length}, counted from 0"),
        )
    })
}

/// Bytes of `n` values of type T, if that many can exist.
fn check_length<T>(n: usize, name: &str) -> Result<()> {
    match n.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(Error::invalid(format!(
            "`{name}` would have {n} values, more than memory can hold"
        ))),
    }
}

/// `n` values to read. NULL is allowed if `n` is 0.
pub(super) unsafe fn slice<'a, T>(pointer: *const T, n: usize, name: &str) -> Result<&'a [T]> {
    if n == 0 {
        return Ok(&[]);
    }
    check(pointer, name)?;
    check_length::<T>(n, name)?;
    // SAFETY: not NULL, aligned, of a possible length, and by contract `n` values are readable.
    Ok(unsafe { std::slice::from_raw_parts(pointer, n) })
}

/// `n` values to write. NULL is allowed if `n` is 0.
pub(super) unsafe fn slice_mut<'a, T>(
    pointer: *mut T,
    n: usize,
    name: &str,
) -> Result<&'a mut [T]> {
    if n == 0 {
        return Ok(&mut []);
    }
    check(pointer, name)?;
    check_length::<T>(n, name)?;
    // SAFETY: not NULL, aligned, of a possible length, and by contract `n` values belong to this
    // call.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, n) })
}

/// A vector of three doubles.
pub(super) unsafe fn array3(pointer: *const f64, name: &str) -> Result<[f64; 3]> {
    // SAFETY: the contract of this function is that of `slice`.
    let values = unsafe { slice(pointer, 3, name) }?;
    Ok([values[0], values[1], values[2]])
}

/// Product of counts, refused if it overflows.
pub(super) fn product(a: usize, b: usize, name: &str) -> Result<usize> {
    a.checked_mul(b)
        .ok_or_else(|| Error::invalid(format!("`{name}`: {a} times {b} values overflow")))
}

/// Layout of `n` points in an array of the host. Both strides 0: interleaved. A scalar needs no
/// component stride.
pub(super) fn strides(n: usize, components: usize, given: [i64; 2], name: &str) -> Result<Strides> {
    let [component, point] = given;
    let component = if component == 0 && point != 0 && components == 1 { 1 } else { component };
    Strides::new(n, components, component, point)
        .map_err(|error| Error { message: format!("`{name}`: {}", error.message), ..error })
}

/// A struct of the API that grows: it begins with `struct_size: u32`.
///
/// # Safety
/// The type is `repr(C)`, begins with a u32, has no padding, and every bit pattern (zero too) is a
/// value of it.
pub(super) unsafe trait Grows: Copy {
    /// Name in the header.
    const NAME: &'static str;
    /// Size of the first released version.
    const FIRST: usize;
}

/// The size that the host gave; checks pointer and size.
unsafe fn struct_size<T: Grows>(pointer: *const T, name: &str) -> Result<usize> {
    check(pointer, name)?;
    // SAFETY: not NULL, aligned; by contract at least the size field is there.
    let size = unsafe { pointer.cast::<u32>().read() } as usize;
    check_struct_size::<T>(size as i64)
}

fn check_struct_size<T: Grows>(size: i64) -> Result<usize> {
    match usize::try_from(size) {
        Ok(size) if (T::FIRST..=LARGEST_STRUCT).contains(&size) => Ok(size),
        _ => Err(Error::new(
            Status::StructSize,
            format!(
                "struct_size of {} is {size}; expected sizeof({0}), which is {}",
                T::NAME,
                size_of::<T>()
            ),
        )),
    }
}

/// Reads a struct that the host filled: the part that both sides know; an unknown tail must be
/// zero.
pub(super) unsafe fn read_struct<T: Grows>(pointer: *const T, name: &str) -> Result<T> {
    // SAFETY: the contract of this function is that of `struct_size`.
    let given = unsafe { struct_size(pointer, name) }?;
    let known = given.min(size_of::<T>());
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: by contract `given` bytes are readable; `known` bytes fit into the value, all bit
    // patterns of which are valid (`Grows`), the rest being zero.
    let value = unsafe {
        pointer.cast::<u8>().copy_to_nonoverlapping(value.as_mut_ptr().cast::<u8>(), known);
        value.assume_init()
    };
    // SAFETY: by contract `given` bytes are readable.
    let tail = unsafe { slice(pointer.cast::<u8>().wrapping_add(known), given - known, name) }?;
    if tail.iter().any(|byte| *byte != 0) {
        let (name, size) = (T::NAME, size_of::<T>());
        let message = format!(
            "{name} has {given} bytes, of which this library knows {size}, and the rest is not zero: \
             the host uses fields of a newer version"
        );
        return Err(Error::new(Status::StructSize, message));
    }
    Ok(value)
}

/// A struct of the host to write a result to.
pub(super) struct StructOut<T> {
    pointer: NonNull<T>,
    given: usize,
}

/// Checks an output struct, whose `struct_size` the host has set.
pub(super) unsafe fn struct_out<T: Grows>(pointer: *mut T, name: &str) -> Result<StructOut<T>> {
    // SAFETY: the contract of this function is that of `struct_size`.
    let given = unsafe { struct_size(pointer, name) }?;
    let pointer = NonNull::new(pointer).ok_or_else(|| null(name))?;
    Ok(StructOut { pointer, given })
}

/// Fills a struct with its defaults; `size` is the host's sizeof.
pub(super) unsafe fn initialise<T: Grows>(
    (pointer, name): (*mut T, &str),
    size: i64,
    value: T,
) -> Result<()> {
    check(pointer, name)?;
    let given = check_struct_size::<T>(size)?;
    let pointer = NonNull::new(pointer).ok_or_else(|| null(name))?;
    StructOut { pointer, given }.set(value);
    Ok(())
}

impl<T: Grows> StructOut<T> {
    /// Writes the part that both sides know, and zeros behind it; the host's `struct_size` stays.
    pub(super) fn set(&self, value: T) {
        let known = self.given.min(size_of::<T>());
        let bytes = self.pointer.as_ptr().cast::<u8>();
        // SAFETY: `given` writable bytes stand at the pointer (contract of the constructors), known
        // <= given and known <= size_of::<T>(); the size field is the first one and was checked for
        // alignment.
        unsafe {
            bytes.write_bytes(0, self.given);
            bytes.copy_from_nonoverlapping((&raw const value).cast::<u8>(), known);
            bytes.cast::<u32>().write(self.given as u32);
        }
    }
}

/// Copies a list of items, each of so many values, to the host. With NULL and capacity 0 only the count is set; a short array is not
/// touched.
pub(super) unsafe fn copy_list<T: Copy>(
    (items, per_item): (usize, usize),
    list: impl Iterator<Item = T>,
    (pointer, capacity): (*mut T, i64),
    count_out: &Out<i64>,
    name: &str,
) -> Result<()> {
    let capacity = count(capacity, "capacity")?;
    if pointer.is_null() && capacity > 0 {
        return Err(null(name));
    }
    count_out.set(items as i64);
    if capacity == 0 {
        return Ok(());
    }
    if capacity < items {
        let message = format!("`{name}` has room for {capacity}, but there are {items}");
        return Err(Error::new(Status::BufferTooSmall, message));
    }
    // SAFETY: by contract `capacity` items are writable, and `items` are not more than that.
    let target = unsafe { slice_mut(pointer, items * per_item, name) }?;
    target.iter_mut().zip(list).for_each(|(target, value)| *target = value);
    Ok(())
}

/// Copies a text with its NUL. With NULL and capacity 0 only the size is set; a short buffer gets
/// the truncated text.
pub(super) unsafe fn copy_text(
    text: &str,
    (buffer, capacity): (*mut c_char, i64),
    needed: Option<&Out<i64>>,
) -> Result<()> {
    let capacity = count(capacity, "capacity")?;
    if let Some(needed) = needed {
        needed.set(text.len() as i64 + 1);
    }
    if capacity == 0 {
        return Ok(());
    }
    let mut end = text.len().min(capacity - 1);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    // SAFETY: by contract `capacity` bytes are writable, and end + 1 <= capacity.
    let target = unsafe { slice_mut(buffer.cast::<u8>(), end + 1, "buffer") }?;
    target[..end].copy_from_slice(&text.as_bytes()[..end]);
    target[end] = 0;
    if end < text.len() {
        let message = format!("the text needs {} bytes, the buffer has {capacity}", text.len() + 1);
        return Err(Error::new(Status::BufferTooSmall, message));
    }
    Ok(())
}

/// The text as a C string; a NUL inside, which C cannot carry, becomes a replacement character.
pub(super) fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}
