//! Which particles of a body move to another index, so that those of a block form one run.

use std::ops::Range;

use crate::error::Result;
use crate::memory::reserve;

/// Particles with consecutive indices that move together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Index of the first one before.
    pub from: u32,
    /// Index of the first one after.
    pub to: u32,
    /// How many.
    pub len: u32,
}

/// Particles that move to another index. First the single ones are taken out; then the segments
/// move one after the other, each onto indices that no particle needs any more; then the single
/// ones are put in.
#[derive(Debug, Default)]
pub struct Moves {
    /// Indices of the single particles before.
    pub from: Vec<u32>,
    /// Their indices after.
    pub to: Vec<u32>,
    /// The particles that move together, in the order in which they must.
    pub segments: Vec<Segment>,
}

/// Lengths of the lists of moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct MovesEnd {
    single: usize,
    segments: usize,
}

/// The moves of one body.
#[derive(Clone, Copy, Debug)]
pub struct BodyMoves<'a> {
    /// Indices of the single particles before.
    pub from: &'a [u32],
    /// Their indices after.
    pub to: &'a [u32],
    /// The particles that move together.
    pub segments: &'a [Segment],
}

impl Moves {
    /// Removes all moves.
    pub fn clear(&mut self) {
        self.from.clear();
        self.to.clear();
        self.segments.clear();
    }

    /// Where the lists end now.
    pub fn end(&self) -> MovesEnd {
        MovesEnd { single: self.from.len(), segments: self.segments.len() }
    }

    /// The moves between two ends.
    pub fn between(&self, start: MovesEnd, end: MovesEnd) -> BodyMoves<'_> {
        let single = start.single..end.single;
        BodyMoves {
            from: &self.from[single.clone()],
            to: &self.to[single],
            segments: &self.segments[start.segments..end.segments],
        }
    }

    /// Makes room for the segments of `runs` runs that `leavers` particles leave; if that takes
    /// more memory, for twice as many.
    pub fn reserve_segments(&mut self, runs: usize, leavers: usize, what: &str) -> Result<()> {
        let more = 2 * runs + leavers;
        if self.segments.capacity() - self.segments.len() >= more {
            return Ok(());
        }
        reserve(&mut self.segments, 2 * more, what)
    }

    /// Adds the moves that sort a body; `order[k]` is the index before of the particle that gets
    /// index k.
    pub fn sort(&mut self, order: &[u32]) {
        for (to, from) in order.iter().enumerate() {
            if *from != to as u32 {
                self.from.push(*from);
                self.to.push(to as u32);
            }
        }
    }

    /// Adds the moves of a run whose indices were `old` and become `new`. Some particles leave it
    /// (`leavers`, ascending), others arrive. Of those that stay, the ones whose indices are in
    /// `new` do not move. The others move as segments to the room, the indices of `new` that are
    /// not in `old`, together with the holes that the leavers make among them; only if the run
    /// shrinks are holes cut out, and when the room is full, the last go one by one into holes
    /// elsewhere. The arrivals get the holes and the room that are left.
    ///
    /// The picture in `step/locate/movers.rs` shows an example.
    pub fn refill(&mut self, old: Range<u32>, new: Range<u32>, leavers: &[u32], arrivals: &[u32]) {
        if new.is_empty() {
            return;
        }
        let mut holes = inside(leavers, old.start.max(new.start)..old.end.min(new.end));
        // only a run that grows at both ends has two rooms, and none of its particles needs one
        let rooms = [new.start..new.end.min(old.start), new.start.max(old.end)..new.end];
        let [mut room, spare] = if rooms[0].is_empty() { [rooms[1].clone(), 0..0] } else { rooms };
        let mut surplus = old.len().saturating_sub(new.len());
        for part in [old.start..old.end.min(new.start), old.start.max(new.end)..old.end] {
            let leavers = inside(leavers, part.clone());
            let (cut, along) = leavers.split_at(surplus.min(leavers.len()));
            surplus -= cut.len();
            let mut next = part.start;
            for leaver in cut {
                self.carry(next..*leaver, &mut room, &mut holes);
                next = leaver + 1;
            }
            self.to.extend(along.iter().map(|leaver| leaver - next + room.start));
            self.carry(next..part.end, &mut room, &mut holes);
        }
        self.to.extend(holes);
        self.to.extend(room);
        self.to.extend(spare);
        self.from.extend_from_slice(arrivals);
        debug_assert_eq!(self.from.len(), self.to.len());
    }

    /// Moves consecutive particles into a room as far as it reaches, and the rest of them into
    /// holes.
    fn carry(&mut self, range: Range<u32>, room: &mut Range<u32>, holes: &mut &[u32]) {
        let whole = range.len().min(room.len()) as u32;
        if whole > 0 {
            self.segments.push(Segment { from: range.start, to: room.start, len: whole });
            room.start += whole;
        }
        let rest = range.start + whole..range.end;
        let (taken, left) = holes.split_at(rest.len());
        *holes = left;
        self.segments.extend(rest.zip(taken).map(|(from, to)| Segment { from, to: *to, len: 1 }));
    }
}

/// The elements of an ascending list that are in a range; a range that ends before it starts has
/// none.
fn inside(list: &[u32], range: Range<u32>) -> &[u32] {
    let start = list.partition_point(|k| *k < range.start);
    let count = list[start..].partition_point(|k| *k < range.end);
    &list[start..start + count]
}

/// Calls `refill` for each run, in an order in which none gets particles onto indices of another
/// that still has to move its own: where the ends of consecutive runs move up, from the last of
/// these runs to the first, elsewhere from the first to the last. `starts` are those of the runs,
/// and at last the end.
pub fn in_order(starts: &[RunStart], mut refill: impl FnMut(usize)) {
    let mut first = 0;
    while first + 1 < starts.len() {
        let mut last = first;
        while starts[last + 1].new > starts[last + 1].old {
            last += 1;
        }
        (first..=last).rev().for_each(&mut refill);
        first = last + 1;
    }
}

/// Where a run starts.
#[derive(Clone, Copy, Debug)]
pub struct RunStart {
    /// Its first index before; that of the next run if it was empty.
    pub old: u32,
    /// Its first index after; that of the next run if it is empty.
    pub new: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Carries out the moves on a row of letters.
    fn moved<T: Copy>(mut row: Vec<T>, moves: &Moves) -> Vec<T> {
        let single: Vec<T> = moves.from.iter().map(|from| row[*from as usize]).collect();
        for Segment { from, to, len } in &moves.segments {
            row.copy_within(*from as usize..(from + len) as usize, *to as usize);
        }
        for (to, mover) in moves.to.iter().zip(single) {
            row[*to as usize] = mover;
        }
        row
    }

    /// The moves between rows of runs in the order of `runs`. `target` names the run of each
    /// particle after, `old` are the lengths of the runs before.
    fn regroup(runs: &[u8], old: &[u32], target: &[u8]) -> Moves {
        let (mut starts, mut at) = (Vec::new(), RunStart { old: 0, new: 0 });
        for (name, old) in runs.iter().zip(old) {
            starts.push(at);
            at.old += old;
            at.new += target.iter().filter(|t| *t == name).count() as u32;
        }
        starts.push(at);
        let mut moves = Moves::default();
        in_order(&starts, |r| {
            let old = starts[r].old..starts[r + 1].old;
            let is_leaver = |k: &u32| target[*k as usize] != runs[r];
            let leavers: Vec<u32> = old.clone().filter(is_leaver).collect();
            let others = (0..target.len() as u32).filter(|k| !old.contains(k));
            let arrivals: Vec<u32> = others.filter(|k| !is_leaver(k)).collect();
            moves.refill(old.clone(), starts[r].new..starts[r + 1].new, &leavers, &arrivals);
        });
        moves
    }

    /// Moves letters from one row of runs to another; the letter is the name of its run after.
    fn regrouped(before: &[&str], runs: &str) -> String {
        let mut old = vec![0; runs.len()];
        for (run, name) in before.iter().zip(b'a'..) {
            old[runs.find(char::from(name)).expect("a run")] = run.len() as u32;
        }
        let row = before.concat().into_bytes();
        let moves = regroup(runs.as_bytes(), &old, &row);
        String::from_utf8(moved(row, &moves)).expect("letters")
    }

    #[test]
    fn runs_are_whole_after_the_moves() {
        assert_eq!(regrouped(&["aab", "bb", "cc"], "abc"), "aabbbcc");
        assert_eq!(regrouped(&["aaaa", "bb", "ccac"], "abc"), "aaaaabbccc");
        assert_eq!(regrouped(&["bbbbbb", "b", "ca"], "abc"), "abbbbbbbc");
        assert_eq!(regrouped(&["aacc", "bdb", "cec"], "daebc"), "daaebbcccc");
        assert_eq!(regrouped(&["cc", "aa"], "dabc"), "aacc");
        assert_eq!(regrouped(&["cab", "abc", "bca"], "abc"), "aaabbbccc");
        assert_eq!(regrouped(&["bbb", "bab", "ccc"], "abc"), "abbbbbccc");
    }

    /// Whole numbers below a bound, the same in every run of the test.
    fn random(state: &mut u64, below: u64) -> u64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) % below
    }

    #[test]
    fn random_rows_are_regrouped_like_a_sort_does() {
        let mut state = 3;
        for round in 0..4000 {
            let runs: Vec<u8> = (0..1 + random(&mut state, 12) as u8).collect();
            let longest = [3, 8, 40][round % 3];
            let old: Vec<u32> = runs
                .iter()
                .map(|_| random(&mut state, longest) as u32 * u32::from(random(&mut state, 4) > 0))
                .collect();
            let (leave, drift) = (1 + random(&mut state, 100), random(&mut state, 2) == 0);
            let mut target = Vec::new();
            for (run, len) in runs.iter().zip(&old) {
                for _ in 0..*len {
                    let leaves = random(&mut state, 100) < leave;
                    let any = runs[random(&mut state, runs.len() as u64) as usize];
                    target.push(if !leaves { *run } else { any * u8::from(!drift) });
                }
            }
            let moves = regroup(&runs, &old, &target);
            let row: Vec<(u8, usize)> = target.iter().copied().zip(0..).collect();
            let mut after = moved(row.clone(), &moves);
            assert!(after.is_sorted_by_key(|(run, _)| *run), "{old:?}, {target:?}");
            after.sort_unstable();
            let mut sorted = row;
            sorted.sort_unstable();
            assert_eq!(after, sorted, "{old:?}, {target:?}");
            let leavers = moves.from.len();
            assert!(moves.segments.len() <= 2 * runs.len() + leavers);
        }
    }

    /// The picture at the top of `step/locate/movers.rs`.
    #[test]
    fn the_picture_of_three_runs_is_true() {
        let row = b"aacabbbbbccaaacc";
        let moves = regroup(b"abc", &[4, 5, 7], row);
        let segment = |from, to, len| Segment { from, to, len };
        assert_eq!(moves.segments, [segment(9, 11, 1), segment(10, 12, 1), segment(4, 9, 2)]);
        assert_eq!(moves.from, [2, 11, 12, 13]);
        assert_eq!(moves.to, [13, 2, 4, 5]);
        assert_eq!(moved(row.to_vec(), &moves), b"aaaaaabbbbbccccc");
    }

    #[test]
    fn particles_that_stay_at_their_index_do_not_move() {
        let mut moves = Moves::default();
        moves.refill(10..20, 8..17, &[12, 15], &[40]);
        let segment = |from, to, len| Segment { from, to, len };
        assert_eq!(moves.segments, [segment(17, 8, 2), segment(19, 12, 1)]);
        assert_eq!((&moves.from[..], &moves.to[..]), (&[40][..], &[15][..]));
    }

    #[test]
    fn holes_go_along_where_arrivals_can_fill_them() {
        let mut moves = Moves::default();
        moves.refill(10..20, 13..24, &[11, 15], &[40, 41, 42]);
        assert_eq!(moves.segments, [Segment { from: 10, to: 20, len: 3 }]);
        assert_eq!(moves.to, [21, 15, 23]);
    }
}
