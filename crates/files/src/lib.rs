//! Files as the programs of the workspace read and write them.
//!
//! Reads stop at a bound. Writes leave a whole file or none. What a message quotes from a file can't steer a terminal.

mod storage;
mod text;

pub use storage::{
    PARTIAL, ReadError, check_regular, read, read_bounded, read_text_bounded, remove_unfinished,
    write_atomically, write_keeping_previous,
};
pub use text::{printable, quoted};
