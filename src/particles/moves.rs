//! Which particles of a body change places, so that those of a block stand together.

use std::ops::Range;

/// Particles that change places: the one at `from[i]` goes to `to[i]`, all at once.
#[derive(Debug, Default)]
pub struct Moves {
    /// Places before.
    pub from: Vec<u32>,
    /// Places after: the same as in `from`, in another order.
    pub to: Vec<u32>,
}

impl Moves {
    /// Forgets all moves.
    pub fn clear(&mut self) {
        self.from.clear();
        self.to.clear();
    }

    /// Adds the moves that sort a body; `order[k]` is the particle that belongs at place k.
    pub fn sort(&mut self, order: &[u32]) {
        for (to, from) in order.iter().enumerate() {
            if *from != to as u32 {
                self.from.push(*from);
                self.to.push(to as u32);
            }
        }
    }

    /// Adds the moves of a run of particles that had the places `old` and gets the places `new`. Some leave it (`leavers`, ascending),
    /// others arrive. Who stays and stands in `new` already does not move; who stays and does not, and then the arrivals,
    /// go to the free places of `new` in ascending order.
    pub fn refill(
        &mut self,
        old: Range<u32>,
        new: Range<u32>,
        leavers: impl Iterator<Item = u32> + Clone,
        arrivals: &[u32],
    ) {
        let inside = |range: Range<u32>| leavers.clone().filter(move |k| range.contains(k));
        self.to.extend(new.start..new.end.min(old.start));
        self.to.extend(inside(new.clone()));
        self.to.extend(new.start.max(old.end)..new.end);
        for part in [old.start..old.end.min(new.start), old.start.max(new.end)..old.end] {
            let mut next = part.start;
            for leaver in inside(part.clone()) {
                self.from.extend(next..leaver);
                next = leaver + 1;
            }
            self.from.extend(next..part.end);
        }
        self.from.extend_from_slice(arrivals);
        debug_assert_eq!(self.from.len(), self.to.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moves letters from one row of runs to another; the letter tells the run in which it belongs.
    fn regrouped(before: &[&str], numbers: &[u8]) -> String {
        let mut line: Vec<u8> = before.concat().into_bytes();
        let all = line.clone();
        let at = |b: usize| before[..b].iter().map(|run| run.len()).sum::<usize>() as u32;
        let mut moves = Moves::default();
        let mut first = 0;
        for letter in numbers {
            let count = all.iter().filter(|l| *l == letter).count() as u32;
            let b = usize::from(letter - b'a');
            let old = if b < before.len() { at(b)..at(b + 1) } else { first..first };
            let others = old.clone().filter(|k| all[*k as usize] != *letter);
            let outside = |k: &u32| !old.contains(k) && all[*k as usize] == *letter;
            let arrivals: Vec<u32> = (0..all.len() as u32).filter(outside).collect();
            moves.refill(old.clone(), first..first + count, others, &arrivals);
            first += count;
        }
        assert_eq!(moves.from.len(), moves.to.len());
        for (from, to) in moves.from.iter().zip(&moves.to) {
            line[*to as usize] = all[*from as usize];
        }
        String::from_utf8(line).expect("letters")
    }

    #[test]
    fn runs_are_whole_after_the_moves() {
        assert_eq!(regrouped(&["aab", "bb", "cc"], b"abc"), "aabbbcc");
        assert_eq!(regrouped(&["aaaa", "bb", "ccac"], b"abc"), "aaaaabbccc");
        assert_eq!(regrouped(&["bbbbbb", "b", "ca"], b"abc"), "abbbbbbbc");
        assert_eq!(regrouped(&["aacc", "bdb", "cec"], b"daebc"), "daaebbcccc");
        assert_eq!(regrouped(&["cc", "aa"], b"dbca"), "ccaa");
        assert_eq!(regrouped(&["cab", "abc", "bca"], b"abc"), "aaabbbccc");
    }

    #[test]
    fn who_stays_in_place_does_not_move() {
        let mut moves = Moves::default();
        moves.refill(10..20, 8..17, [12, 15].into_iter(), &[40]);
        assert_eq!(moves.to, [8, 9, 12, 15]);
        assert_eq!(moves.from, [17, 18, 19, 40]);
    }
}
