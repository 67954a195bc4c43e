//! Tables of the host: values over time, piecewise linear between the rows. The first row also
//! holds before its time, the last row also after its time.

use super::arguments::{count, product, slice};
use crate::boundary::Table;
use crate::error::Result;
use crate::memory::collect;

/// A table over time. Times must increase, and all numbers must be finite.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_table {
    /// Number of rows; 0: no table, the condition is constant.
    pub count: i64,
    /// Times [s], shape [count]. Read during the call only.
    pub times: *const f64,
    /// Values; unit and shape are given where the table is used. Read during the call only.
    pub values: *const f64,
}

/// No table.
pub(super) const NO_TABLE: lahar_table =
    lahar_table { count: 0, times: std::ptr::null(), values: std::ptr::null() };

/// The table with `components` values in a row, each row turned into a vector; None without rows.
pub(super) unsafe fn to_table(
    table: &lahar_table,
    what: &str,
    components: usize,
    to_vector: impl Fn(&[f64]) -> [f64; 3],
) -> Result<Option<Table>> {
    let n = count(table.count, "count")?;
    if n == 0 {
        return Ok(None);
    }
    // SAFETY: by contract of the caller the pointers are NULL or hold as many values as the count
    // says.
    let (times, values) = unsafe {
        (
            slice(table.times, n, "times")?,
            slice(table.values, product(n, components, "values")?, "values")?,
        )
    };
    let rows = collect(values.chunks_exact(components).map(to_vector), "the rows of a table")?;
    Table::new(what, times, &rows).map(Some)
}
