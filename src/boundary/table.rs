//! Tables over time: what a condition is at a time, piecewise linear between the rows.

use crate::error::{Error, Result};
use crate::memory::collect;

/// What memory is for, if there is none.
const WHAT: &str = "the rows of a table";

/// Rows of time [s] and three values; before the first row and after the last one the values of
/// that row hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<[f64; 3]>,
}

impl Table {
    /// The same at all times.
    pub fn constant(value: [f64; 3]) -> Self {
        Self { times: vec![0.0], values: vec![value] }
    }

    /// A table with these rows. Times must increase and all numbers be finite; `what` names the
    /// table in errors.
    pub fn new(what: &str, times: &[f64], values: &[[f64; 3]]) -> Result<Self> {
        if times.is_empty() || times.len() != values.len() {
            return Err(Error::invalid(format!(
                "the table of {what} needs as many times as values and at least one row, got {} and {}",
                times.len(),
                values.len()
            )));
        }
        for (row, (time, value)) in times.iter().zip(values).enumerate() {
            if !(time.is_finite() && value.iter().all(|v| v.is_finite())) {
                return Err(Error::invalid(format!(
                    "row {row} of the table of {what} must be finite, got {value:?} at {time} s"
                )));
            }
            if row > 0 && *time <= times[row - 1] {
                return Err(Error::invalid(format!(
                    "the times of the table of {what} must increase: row {row} has {time} s after {} s, so that what \
                     begins in row {} would end before it begins",
                    times[row - 1],
                    row - 1
                )));
            }
        }
        let (times, values) = (times.iter().copied(), values.iter().copied());
        Ok(Self { times: collect(times, WHAT)?, values: collect(values, WHAT)? })
    }

    /// The same table with zeros in the components for which `is_used` is false.
    pub fn keeping(mut self, is_used: impl Fn(usize) -> bool) -> Self {
        for value in &mut self.values {
            (0..3).filter(|c| !is_used(*c)).for_each(|c| value[c] = 0.0);
        }
        self
    }

    /// The values of all rows.
    pub fn rows(&self) -> &[[f64; 3]] {
        &self.values
    }

    /// The values at a time [s].
    pub fn at(&self, time: f64) -> [f64; 3] {
        let next = self.times.partition_point(|t| *t <= time);
        if next == 0 {
            return self.values[0];
        }
        let (before, a) = (self.times[next - 1], self.values[next - 1]);
        let Some((after, b)) = self.times.get(next).zip(self.values.get(next)) else {
            return a;
        };
        let part = (time - before) / (after - before); // [CND-1]
        std::array::from_fn(|c| a[c] + part * (b[c] - a[c]))
    }

    /// The largest length of the vector of values in a span of time: it is that of an end or of a
    /// row, since the length of what changes linearly is convex.
    pub fn largest(&self, from: f64, until: f64) -> f64 {
        let rows =
            self.times.partition_point(|t| *t <= from)..self.times.partition_point(|t| *t < until);
        let inside = self.values.get(rows).unwrap_or_default();
        let ends = [self.at(from), self.at(until)];
        ends.iter().chain(inside).map(length).fold(0.0, f64::max)
    }

    /// The time of the last row [s]; negative infinity for a table that never changes.
    pub fn end(&self) -> f64 {
        match self.times[..] {
            [_, .., last] => last,
            _ => f64::NEG_INFINITY,
        }
    }
}

/// Length of a vector.
pub fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Table {
        let values = [[0.0; 3], [0.0, -10.0, 0.0], [0.0, 4.0, 3.0]];
        Table::new("test", &[1.0, 3.0, 4.0], &values).expect("a good table")
    }

    #[test]
    fn values_are_linear_between_rows_and_constant_outside() {
        let table = ramp();
        for (time, y) in
            [(-1.0, 0.0), (1.0, 0.0), (2.0, -5.0), (3.0, -10.0), (3.5, -3.0), (9.0, 4.0)]
        {
            assert_eq!(table.at(time)[1], y, "at {time}");
        }
        assert_eq!(Table::constant([1.0, 2.0, 3.0]).at(-5.0), [1.0, 2.0, 3.0]);
        assert_eq!((table.end(), Table::constant([1.0; 3]).end()), (4.0, f64::NEG_INFINITY));
    }

    #[test]
    fn the_largest_value_of_a_span_is_found_at_its_ends_or_at_a_row() {
        let table = ramp();
        for (from, until, largest) in [
            (0.0, 0.5, 0.0),
            (0.0, 2.0, 5.0),
            (2.0, 3.5, 10.0),
            (5.0, f64::MAX, 5.0),
            (0.0, 1e9, 10.0),
        ] {
            assert_eq!(table.largest(from, until), largest, "{from} to {until}");
        }
    }

    #[test]
    fn a_bad_table_is_an_error_that_names_the_row() {
        let text = |times: &[f64], values: &[[f64; 3]]| {
            Table::new("gravity", times, values).expect_err("a bad table").message
        };
        let zero = [0.0; 3];
        assert!(text(&[], &[]).contains("at least one row"));
        assert!(text(&[2.0, 1.0], &[zero, zero]).contains("row 1 has 1 s after 2 s"));
        assert!(text(&[1.0, 1.0], &[zero, zero]).contains("row 1 has 1 s after 1 s"));
        assert!(text(&[0.0, f64::NAN], &[zero, zero]).contains("row 1 of the table of gravity"));
        assert!(text(&[0.0], &[[0.0, f64::INFINITY, 0.0]]).contains("row 0 of the table"));
    }
}
