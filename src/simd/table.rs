//! A table of doubles that threads divide among themselves: by columns, and each column by rows.
//!
//! Slices cannot express that two threads hold other rows of the same columns, but for one slice a
//! column; and a body may have thousands of columns.

use std::marker::PhantomData;

/// Columns of doubles, `stride` apart; each has `rows` of them.
pub struct Table<'a> {
    first: *mut f64,
    stride: usize,
    columns: usize,
    rows: usize,
    data: PhantomData<&'a mut [f64]>,
}

// SAFETY: a table is a set of elements of a slice that was borrowed for writing, and no two tables
// share one; doubles may go to other threads.
unsafe impl Send for Table<'_> {}
// SAFETY: as above; through a shared table elements are only read.
unsafe impl Sync for Table<'_> {}

impl<'a> Table<'a> {
    /// The first `rows` of every column in `data`; columns are `stride` apart.
    pub fn new(data: &'a mut [f64], stride: usize, rows: usize) -> Self {
        assert!(rows <= stride, "{rows} rows in columns of {stride}");
        let columns = data.len().checked_div(stride).unwrap_or(0);
        let rows = if columns == 0 { 0 } else { rows };
        Self { first: data.as_mut_ptr(), stride, columns, rows, data: PhantomData }
    }

    /// Number of columns.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// A column.
    #[inline(always)]
    pub fn column(&self, c: usize) -> &[f64] {
        assert!(c < self.columns);
        // SAFETY: the column is one of the table, whose elements nobody writes while it is shared.
        unsafe { std::slice::from_raw_parts(self.first.add(c * self.stride), self.rows) }
    }

    /// A column, to write.
    #[inline(always)]
    pub fn column_mut(&mut self, c: usize) -> &mut [f64] {
        assert!(c < self.columns);
        // SAFETY: the column is one of the table, which is borrowed for writing as long as the
        // slice lives.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(c * self.stride), self.rows) }
    }

    /// Its `N` columns, to write; empty ones if the table has none.
    #[inline(always)]
    pub fn into_columns<const N: usize>(self) -> [&'a mut [f64]; N] {
        let [columns] = self.into_groups();
        columns
    }

    /// Its `N * N` columns, to write, row by row of a matrix; empty ones if the table has none.
    #[inline(always)]
    pub fn into_matrix<const N: usize>(self) -> [[&'a mut [f64]; N]; N] {
        self.into_groups()
    }

    #[inline(always)]
    fn into_groups<const M: usize, const N: usize>(self) -> [[&'a mut [f64]; N]; M] {
        let present = self.columns > 0;
        assert!(!present || M * N == self.columns);
        std::array::from_fn(|a| {
            std::array::from_fn(|b| match present {
                // SAFETY: the column is one of the table, which is consumed, and each is given away
                // once.
                true => unsafe {
                    let first = self.first.add((N * a + b) * self.stride);
                    std::slice::from_raw_parts_mut(first, self.rows)
                },
                false => Default::default(),
            })
        })
    }

    /// Some of the rows for a while.
    #[inline(always)]
    pub fn some_rows(&mut self, first: usize, rows: usize) -> Table<'_> {
        assert!(first <= self.rows && rows <= self.rows - first);
        let first = self.first.wrapping_add(first);
        Table { first, rows, data: PhantomData, ..*self }
    }

    /// The columns before `at`, and the others.
    #[inline(always)]
    pub fn split_columns(self, at: usize) -> (Self, Self) {
        assert!(at <= self.columns);
        // where no column is left, the address may lie outside, and nothing is read there
        let right = self.first.wrapping_add(at * self.stride);
        let columns = self.columns - at;
        (Self { columns: at, ..self }, Self { first: right, columns, ..self })
    }

    /// The rows before `at`, and the others.
    pub fn split_rows(self, at: usize) -> (Self, Self) {
        assert!(at <= self.rows);
        let right = self.first.wrapping_add(at);
        let rows = self.rows - at;
        (Self { rows: at, ..self }, Self { first: right, rows, ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_table_hold_other_elements() {
        let mut data: Vec<f64> = (0..12).map(f64::from).collect();
        let table = Table::new(&mut data, 4, 3);
        assert_eq!((table.columns(), table.rows()), (3, 3));
        let (left, right) = table.split_columns(1);
        let (mut upper, lower) = right.split_rows(2);
        assert_eq!((left.column(0), lower.column(1)), (&[0.0, 1.0, 2.0][..], &[10.0][..]));
        upper.some_rows(1, 1).column_mut(1)[0] = -9.0;
        let [a, b] = upper.into_columns::<2>();
        assert_eq!((&*a, &*b), (&[4.0, 5.0][..], &[8.0, -9.0][..]));
        assert_eq!(data[9], -9.0);
    }

    #[test]
    fn what_is_behind_the_last_column_of_shifted_rows_is_empty() {
        let mut data = [0.0; 8];
        let (_, lower) = Table::new(&mut data, 4, 4).split_rows(3);
        let (left, none) = lower.split_columns(2);
        assert_eq!((left.columns(), none.columns(), none.rows()), (2, 0, 1));
        assert!(none.into_columns::<3>().iter().all(|column| column.is_empty()));
    }

    #[test]
    #[should_panic(expected = "first <= self.rows")]
    fn rows_outside_the_table_are_refused() {
        Table::new(&mut [0.0; 8], 4, 4).some_rows(usize::MAX, 2);
    }

    #[test]
    fn an_empty_table_has_no_columns() {
        assert_eq!(Table::new(&mut [], 0, 0).columns(), 0);
        let mut one = [1.0];
        let [none] = Table::new(&mut one, 1, 1).split_columns(1).1.into_columns();
        assert!(none.is_empty());
    }
}
