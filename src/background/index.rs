//! Where a key stands in a list of keys: an open-addressing table of positions, so that memory is
//! reserved before a step needs it.

use super::blocks::NONE;
use super::key::Key;
use crate::error::Result;
use crate::memory::reserve;

/// Positions of keys in a list that the caller owns. The table has buckets, at most half of them
/// full.
#[derive(Debug, Default)]
pub struct Index {
    table: Vec<u32>,
}

impl Index {
    /// Makes room for `count` keys in all.
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory), with the table as it
    /// was.
    pub fn reserve<const D: usize>(&mut self, count: usize, keys: &[Key<D>]) -> Result<()> {
        if 2 * count <= self.table.len() {
            return Ok(());
        }
        let size = (2 * count).next_power_of_two().max(16);
        let mut table = Vec::new();
        reserve(&mut table, size, "the table of blocks")?;
        table.resize(size, NONE);
        let old = std::mem::replace(&mut self.table, table);
        for position in old.into_iter().filter(|position| *position != NONE) {
            self.insert(position, keys);
        }
        Ok(())
    }

    /// Removes all keys.
    pub fn clear(&mut self) {
        self.table.fill(NONE);
    }

    /// Position of a key.
    #[inline]
    pub fn find<const D: usize>(&self, key: &Key<D>, keys: &[Key<D>]) -> Option<u32> {
        let mask = self.table.len().checked_sub(1)?;
        let mut bucket = home(key) & mask;
        loop {
            match self.table[bucket] {
                NONE => return None,
                position if keys[position as usize] == *key => return Some(position),
                _ => bucket = (bucket + 1) & mask,
            }
        }
    }

    /// Adds the key at a position of the list; there is room, and the key is not in the table.
    pub fn insert<const D: usize>(&mut self, position: u32, keys: &[Key<D>]) {
        let mask = self.table.len() - 1;
        let mut bucket = home(&keys[position as usize]) & mask;
        while self.table[bucket] != NONE {
            bucket = (bucket + 1) & mask;
        }
        self.table[bucket] = position;
    }

    /// Removes the key at a position of the list, and moves keys up that stood behind it because
    /// their own bucket was taken.
    pub fn remove<const D: usize>(&mut self, position: u32, keys: &[Key<D>]) {
        let mask = self.table.len() - 1;
        let mut hole = home(&keys[position as usize]) & mask;
        while self.table[hole] != position {
            hole = (hole + 1) & mask;
        }
        let mut bucket = hole;
        loop {
            bucket = (bucket + 1) & mask;
            let other = self.table[bucket];
            if other == NONE {
                break;
            }
            let from_home = bucket.wrapping_sub(home(&keys[other as usize])) & mask;
            if from_home >= bucket.wrapping_sub(hole) & mask {
                self.table[hole] = other;
                hole = bucket;
            }
        }
        self.table[hole] = NONE;
    }

    /// Memory [bytes].
    pub fn bytes(&self) -> usize {
        self.table.capacity() * size_of::<u32>()
    }
}

/// The bucket of a key if it is free, before the mask: its layer and coordinates, mixed.
fn home<const D: usize>(key: &Key<D>) -> usize {
    let mix = |h: u64, k: &i32| {
        (h.rotate_left(23) ^ u64::from(*k as u32)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    };
    (key.at.iter().fold(u64::from(key.layer), mix) >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_after_others_went() {
        let keys: Vec<Key<2>> =
            (0..900).map(|n| Key { layer: 0, at: [n % 30 - 15, n / 30 - 7] }).collect();
        let mut index = Index::default();
        assert_eq!(index.find(&keys[0], &keys), None);
        for n in 0..900 {
            index.reserve(n as usize + 1, &keys).expect("memory");
            index.insert(n, &keys);
        }
        for n in (0..900).step_by(3) {
            index.remove(n, &keys);
        }
        for n in 0..900 {
            let expected = (n % 3 != 0).then_some(n);
            assert_eq!(index.find(&keys[n as usize], &keys), expected);
        }
    }
}
