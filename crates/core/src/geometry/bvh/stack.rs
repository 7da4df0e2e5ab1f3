//! What a walk has still to visit.

use super::Child;
use std::mem::MaybeUninit;

/// A child with where the ray enters it; such entries order as the distances, which are not negative, do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    #[inline(always)]
    pub fn new(enter: f32, child: Child) -> Entry {
        Entry(u64::from(enter.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    pub fn child(self) -> Child {
        Child(self.0 as u32)
    }

    /// Whether the ray enters it at a distance, which is not negative, or before.
    #[inline(always)]
    pub fn within(self, distance: f32) -> bool {
        self.0 >> 32 <= u64::from(distance.to_bits())
    }
}

/// A stack in memory that is not cleared beforehand: a walk needs little of what it may need, and clearing all of it for each
/// ray takes a twentieth of the ray's time.
pub(super) struct Stack<'a> {
    /// The first `len` are initialised.
    entries: &'a mut [MaybeUninit<Entry>],
    len: usize,
}

impl<'a> Stack<'a> {
    /// An empty stack with room for as many entries as the slice has.
    #[inline(always)]
    pub fn new(entries: &'a mut [MaybeUninit<Entry>]) -> Stack<'a> {
        Stack { entries, len: 0 }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// # Panics
    /// When it is full.
    #[inline(always)]
    pub fn push(&mut self, entry: Entry) {
        self.entries[self.len].write(entry);
        self.len += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<Entry> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: it was one of the first `len`.
        Some(unsafe { self.entries[self.len].assume_init() })
    }

    /// Pushes an entry below those that are nearer, but not below the first `bottom` entries.
    ///
    /// # Panics
    /// When it is full.
    #[inline(always)]
    pub fn insert(&mut self, entry: Entry, bottom: usize) {
        let mut i = self.len;
        // SAFETY: `i` is at most `len`.
        while i > bottom && unsafe { self.entries[i - 1].assume_init() } < entry {
            self.entries[i] = self.entries[i - 1];
            i -= 1;
        }
        self.entries[i].write(entry);
        self.len += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_come_first_above_what_was_there() {
        let mut entries = [MaybeUninit::uninit(); 8];
        let mut stack = Stack::new(&mut entries);
        let entry = |distance: f32| Entry::new(distance, Child::node(distance as u32));
        stack.push(entry(1.0));
        stack.push(entry(5.0));
        for distance in [4.0, 2.0, 7.0, 3.0, 0.0] {
            stack.insert(entry(distance), 2);
        }
        assert_eq!(stack.len(), 7);
        for expected in [0.0, 2.0, 3.0, 4.0, 7.0, 5.0, 1.0] {
            let top = stack.pop().unwrap();
            assert_eq!(top.child(), Child::node(expected as u32));
            assert!(top.within(expected) && (expected == 0.0 || !top.within(expected - 0.5)));
        }
        assert!(stack.pop().is_none() && stack.len() == 0);
    }

    #[test]
    #[should_panic]
    fn it_does_not_overflow() {
        let mut entries = [MaybeUninit::uninit(); 1];
        let mut stack = Stack::new(&mut entries);
        stack.push(Entry::new(1.0, Child::node(0)));
        stack.push(Entry::new(2.0, Child::node(0)));
    }
}
