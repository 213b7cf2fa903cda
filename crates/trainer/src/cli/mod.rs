//! The verbs of the program.

pub(crate) mod average;
pub(crate) mod compare;
pub(crate) mod evaluate;
pub(crate) mod export;
pub(crate) mod import;
pub(crate) mod interrupt;
pub(crate) mod keep;
pub(crate) mod load;
pub(crate) mod normaliser;
pub(crate) mod output;
pub(crate) mod pack;
pub(crate) mod pca;
pub(crate) mod search;
pub(crate) mod strip;
pub(crate) mod train;
pub(crate) mod view;
