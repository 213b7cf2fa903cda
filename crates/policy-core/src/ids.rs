//! Typed indices. An id is looked up by name once and used on every tick.

/// Defines a newtype over an index.
macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(u16);

        impl $name {
            /// The id of an index. Indices above 65,535 become 65,535, which no pack reaches.
            #[must_use]
            pub const fn new(index: usize) -> Self {
                Self(if index > u16::MAX as usize { u16::MAX } else { index as u16 })
            }

            /// Index into the list that the id belongs to.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id! {
    /// A body of a [`Skeleton`](crate::Skeleton).
    BodyId
}
id! {
    /// A hinge of a [`Skeleton`](crate::Skeleton).
    JointId
}
id! {
    /// A policy of a [`CharacterPack`](crate::CharacterPack).
    PolicyId
}
id! {
    /// A node of a [`PolicyGraph`](crate::PolicyGraph). Its policy has the same index.
    NodeId
}
id! {
    /// A path of a [`PolicyGraph`](crate::PolicyGraph).
    PathId
}
id! {
    /// An episodic skill of a [`CharacterPack`](crate::CharacterPack).
    SkillId
}
id! {
    /// A discriminator of a [`CharacterPack`](crate::CharacterPack).
    DiscriminatorId
}

impl From<NodeId> for PolicyId {
    fn from(node: NodeId) -> Self {
        Self(node.0)
    }
}
