//! The demo: a humanoid steered by pad, keyboard and mouse.
fn main() {}
