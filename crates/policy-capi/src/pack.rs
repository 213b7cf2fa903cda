//! The pack behind a handle: loading, names, texts.

use std::ffi::{CString, c_char};
use std::fs::File;
use std::io::Read as _;
use std::ptr;
use std::sync::Arc;

use policy_core::CharacterPack;
use policy_core::format::MAX_PACK_BYTES;

use crate::PS_NONE;
use crate::border::{id, index, present, text};
use crate::error::{PsStatus, fail, guard_or};

/// A character: skeleton, policies, graph, skills, normalisers. Immutable, shared by its controllers.
pub struct PsPack {
    pub(crate) pack: Arc<CharacterPack>,
    character: CString,
    /// By [`PsPart`].
    names: [Vec<CString>; 5],
    mjcf: Option<CString>,
}

// Several threads may use one pack.
const _: fn() = || {
    fn shared<T: Send + Sync>() {}
    shared::<PsPack>();
};

/// Kinds of parts that have names.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsPart {
    /// Bodies, the root first, each parent before its children: the order of PsSensed.bodies.
    Body = 0,
    /// Hinges: the order of joint velocities, actions and joint targets.
    Joint = 1,
    /// Nodes of the policy graph. The policy of a node has the same index.
    Node = 2,
    /// Paths of the policy graph.
    Path = 3,
    /// Episodic skills.
    Skill = 4,
}

impl PsPack {
    fn new(pack: CharacterPack) -> Self {
        let skeleton = pack.skeleton();
        let names = [
            skeleton.bodies().iter().map(|b| c_string(&b.name)).collect(),
            skeleton.joints().iter().map(|j| c_string(&j.name)).collect(),
            pack.graph().nodes().iter().map(|n| c_string(&n.name)).collect(),
            pack.graph().paths().iter().map(|p| c_string(p.name())).collect(),
            pack.skills().iter().map(|s| c_string(&s.name)).collect(),
        ];
        let character = c_string(&pack.manifest().character);
        let mjcf = pack.mjcf().map(c_string);
        Self { pack: Arc::new(pack), character, names, mjcf }
    }

    fn names(&self, part: i32) -> Result<&[CString], PsStatus> {
        Ok(&self.names[index("kind of part", part, self.names.len())?])
    }
}

/// A text for C: zeros, which would end it early, become question marks.
fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "?")).expect("zeros were replaced")
}

/// A pack from the bytes of a file of version 1 or 2. NULL on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_pack_from_bytes(bytes: *const u8, len: usize) -> Option<Box<PsPack>> {
    guard_or(None, || {
        check_len(len as u64)?;
        // SAFETY: the contract of every function.
        parse(unsafe { crate::border::input("the bytes of a pack", bytes, len, len) }?).map(Some)
    })
}

/// A pack from a file; the path is UTF-8. NULL on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_pack_from_file(path: *const c_char) -> Option<Box<PsPack>> {
    guard_or(None, || {
        // SAFETY: the contract of every function.
        let path = unsafe { text("the path of a pack", path) }?;
        let unreadable =
            |e: std::io::Error| fail(PsStatus::File, format_args!("expected a pack at {path:?}, found {e}"));
        let file = File::open(path).map_err(unreadable)?;
        let len = file.metadata().map_err(unreadable)?.len();
        check_len(len)?;
        let mut bytes = Vec::with_capacity(len as usize);
        // The file may grow meanwhile.
        file.take(MAX_PACK_BYTES as u64).read_to_end(&mut bytes).map_err(unreadable)?;
        parse(&bytes).map(Some)
    })
}

fn check_len(len: u64) -> Result<(), PsStatus> {
    if len > MAX_PACK_BYTES as u64 {
        let text = format_args!("expected a pack of at most {MAX_PACK_BYTES} bytes, found {len}");
        return Err(fail(PsStatus::BadPack, text));
    }
    Ok(())
}

fn parse(bytes: &[u8]) -> Result<Box<PsPack>, PsStatus> {
    match CharacterPack::from_bytes(bytes) {
        Ok(pack) => Ok(Box::new(PsPack::new(pack))),
        Err(e) => Err(fail(PsStatus::BadPack, format_args!("{e}"))),
    }
}

/// Frees a pack. Its controllers and states go on.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_free(pack: Option<Box<PsPack>>) {
    guard_or((), || {
        drop(pack);
        Ok(())
    });
}

/// Number of parts of a kind (PsPart). 0 also on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_count(pack: Option<&PsPack>, part: i32) -> usize {
    guard_or(0, || Ok(present("a pack", pack)?.names(part)?.len()))
}

/// Name of a part. NULL on failure. Valid as long as the pack.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_name(pack: Option<&PsPack>, part: i32, part_index: i32) -> *const c_char {
    guard_or(ptr::null(), || {
        let names = present("a pack", pack)?.names(part)?;
        Ok(names[index("part", part_index, names.len())?].as_ptr())
    })
}

/// Index of the part with this name. PS_NONE on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_pack_find(pack: Option<&PsPack>, part: i32, name: *const c_char) -> i32 {
    guard_or(PS_NONE, || {
        let names = present("a pack", pack)?.names(part)?;
        // SAFETY: the contract of every function.
        let name = unsafe { text("the name of a part", name) }?;
        let found = names.iter().position(|n| n.to_bytes() == name.as_bytes());
        found.map(id).ok_or_else(|| {
            let kind = ["body", "joint", "node", "path", "skill"][part as usize];
            fail(PsStatus::BadName, format_args!("expected the name of a {kind} of the pack, found {name:?}"))
        })
    })
}

/// Name of the character. NULL on failure. Valid as long as the pack.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_character(pack: Option<&PsPack>) -> *const c_char {
    guard_or(ptr::null(), || Ok(present("a pack", pack)?.character.as_ptr()))
}

/// The body as MJCF text, UTF-8. NULL on failure and for packs of version 1. Valid as long as the pack.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_mjcf(pack: Option<&PsPack>) -> *const c_char {
    guard_or(ptr::null(), || {
        let mjcf = present("a pack", pack)?.mjcf.as_ref();
        mjcf.map(|text| text.as_ptr()).ok_or_else(|| absent("MJCF text"))
    })
}

/// The skinned mesh, a binary glTF file of `*len` bytes. NULL on failure and for packs without one. Valid as long as the
/// pack.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_mesh(pack: Option<&PsPack>, len: Option<&mut usize>) -> *const u8 {
    guard_or(ptr::null(), || {
        let (pack, len) = (present("a pack", pack)?, present("the place of a length", len)?);
        let mesh = pack.pack.mesh().ok_or_else(|| absent("a skinned mesh"))?;
        *len = mesh.len();
        Ok(mesh.as_ptr())
    })
}

/// The failure of a pack that lacks something.
pub(crate) fn absent(what: &str) -> PsStatus {
    fail(PsStatus::Absent, format_args!("expected a pack with {what}, found one without"))
}
