//! Integer coordinates of blocks and their order.

use std::cmp::Ordering;

/// Nodes along the edge of a block.
pub const EDGE: usize = 4;

/// Which block: its layer and its integer coordinates. It holds the nodes `4 * at .. 4 * at + 3`
/// along each axis.
///
/// Layers are velocity fields that stand at the same coordinates; blocks of one are no neighbours
/// of those of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key<const D: usize> {
    /// The layer; 0 for all bodies that share a velocity field.
    pub layer: u32,
    /// Coordinates, in blocks.
    pub at: [i32; D],
}

/// Nodes of a block.
pub const fn block_nodes(dimension: usize) -> usize {
    EDGE.pow(dimension as u32)
}

/// Order of keys: by layer, then along the Morton curve, found without interleaving bits: the axis
/// whose coordinates differ in the highest bit decides; the first axis wins ties. Flipping the sign
/// bit makes negative coordinates ordinary.
pub fn morton_order<const D: usize>(a: &Key<D>, b: &Key<D>) -> Ordering {
    if a.layer != b.layer {
        return a.layer.cmp(&b.layer);
    }
    let (a, b) = (&a.at, &b.at);
    let flip = |v: i32| (v as u32) ^ 0x8000_0000;
    let (mut axis, mut highest) = (0, 0u32);
    for d in 0..D {
        let difference = flip(a[d]) ^ flip(b[d]);
        if has_higher_top_bit(difference, highest) {
            axis = d;
            highest = difference;
        }
    }
    flip(a[axis]).cmp(&flip(b[axis]))
}

/// Whether the highest bit that is set in a is above that of b: then a is larger, and a ^ b has it.
#[inline(always)]
fn has_higher_top_bit(a: u32, b: u32) -> bool {
    b < a && b < (a ^ b)
}

/// Block and position in it of a node along one axis.
pub fn split_node(node: i64) -> (i64, usize) {
    (node.div_euclid(EDGE as i64), node.rem_euclid(EDGE as i64) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn key<const D: usize>(at: [i32; D]) -> Key<D> {
        Key { layer: 0, at }
    }

    /// The Morton code of coordinates below 8, bit by bit, the first axis highest.
    fn interleaved(key: Key<3>) -> i32 {
        let bits = |bit: i32| (0..3).fold(0, |code, d| 2 * code + (key.at[d] >> bit & 1));
        (0..3).fold(0, |code, bit| 8 * code + bits(2 - bit))
    }

    #[test]
    fn the_order_is_that_of_interleaved_bits() {
        let mut keys: Vec<Key<3>> = (0..512).map(|i| key([i % 8, i / 64, i / 8 % 8])).collect();
        keys.sort_by(morton_order);
        assert!(keys.iter().enumerate().all(|(n, key)| interleaved(*key) == n as i32));
    }

    #[test]
    fn negative_keys_come_before_positive_ones() {
        assert_eq!(morton_order(&key([-1, 5]), &key([0, -5])), Ordering::Less);
        assert_eq!(morton_order(&key([3, -7]), &key([3, -7])), Ordering::Equal);
        assert_eq!(split_node(-1), (-1, 3));
        assert_eq!(split_node(7), (1, 3));
    }
}
