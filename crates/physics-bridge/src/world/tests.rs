//! What needs the inside of a world.
