//! Some of what can be measured, chosen by name.

use std::marker::PhantomData;

/// A list of at most 32 things that have names.
pub trait Named: Copy {
    /// Their names, always in the same order.
    fn names() -> Vec<&'static str>;
}

/// Some of the things of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen<L> {
    bits: u32,
    list: PhantomData<L>,
}

impl<L: Named> Chosen<L> {
    /// None of them.
    pub const NONE: Self = Self::of_bits(0);
    /// All of them.
    pub const ALL: Self = Self::of_bits(u32::MAX);

    const fn of_bits(bits: u32) -> Self {
        Self { bits, list: PhantomData }
    }

    /// The names of all of the list.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        L::names()
    }

    /// The one called `name` alone; `None` when there is none of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        L::names().iter().position(|known| *known == name).map(|index| Self::of_bits(1 << index))
    }

    /// Those of either.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self::of_bits(self.bits | other.bits)
    }

    /// True when the one called `name` is among them.
    #[must_use]
    pub fn contains(self, name: &str) -> bool {
        Self::from_name(name).is_some_and(|one| self.bits & one.bits != 0)
    }

    /// How many there are.
    #[must_use]
    pub fn count(self) -> usize {
        L::names().iter().filter(|name| self.contains(name)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    struct Letters;

    impl Named for Letters {
        fn names() -> Vec<&'static str> {
            vec!["a", "b", "c"]
        }
    }

    #[test]
    fn those_of_some_names_and_no_others() {
        let of = |name| Chosen::<Letters>::from_name(name).unwrap();
        let some = of("a").and(of("c"));
        assert_eq!(["a", "b", "c", "d"].map(|name| some.contains(name)), [true, false, true, false]);
        assert_eq!([some, Chosen::NONE, Chosen::ALL].map(Chosen::count), [2, 0, 3]);
        assert_eq!(Chosen::<Letters>::from_name("d"), None);
    }
}
