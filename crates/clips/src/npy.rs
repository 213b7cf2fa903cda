//! IsaacGym's AMP clips: a `.npy` file with one pickled dictionary of local rotations (xyzw), root translation and rate.
//! The bodies are the humanoid's, in its order.

use files::quoted;
use glam::{Quat, Vec3};

use super::pickle::{Id, Object, Pickle};
use super::{Clip, ClipError, humanoid};

/// Reads the bytes of an AMP clip.
///
/// # Errors
/// When it is not such a clip.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Clip, ClipError> {
    read(name, bytes)
        .map_err(|message| ClipError::Format { clip: name.into(), message: quoted(&message) })?
        .checked()
}

fn read(name: &str, bytes: &[u8]) -> Result<Clip, String> {
    let pickle = Pickle::parse(payload(bytes)?)?;
    let dict = dictionary(&pickle, pickle.root())?;
    let item =
        |of: Id, key: &str| pickle.item(of, key).ok_or_else(|| format!("expected `{key}`, found none"));
    let rotations = array(&pickle, item(item(dict, "rotation")?, "arr")?)?;
    let positions = array(&pickle, item(item(dict, "root_translation")?, "arr")?)?;
    let bodies = humanoid::bodies();
    let count = bodies.len();
    if rotations.shape.len() != 3 || rotations.shape[1..] != [count, 4] {
        return Err(format!("expected rotations of shape [frames, {count}, 4], found {:?}", rotations.shape));
    }
    if positions.shape != [rotations.shape[0], 3] {
        return Err(format!("expected translations of shape [frames, 3], found {:?}", positions.shape));
    }
    let fps = match pickle.object(item(dict, "fps")?) {
        Object::Int(fps) => *fps as f32,
        Object::Float(fps) => *fps as f32,
        other => return Err(format!("expected a number in `fps`, found {other:?}")),
    };
    if !(1.0..=1000.0).contains(&fps) {
        return Err(format!("expected 1 to 1000 in `fps`, found {fps}"));
    }
    // `chunks_exact` gives chunks of that length, and the shapes are as checked above.
    let quat = |v: &[f32]| Quat::from_xyzw(v[0], v[1], v[2], v[3]);
    let frame = |v: &[f32]| v.chunks_exact(4).map(quat).collect();
    Ok(Clip {
        name: name.into(),
        looping: false,
        bodies,
        times: (0..rotations.shape[0]).map(|i| i as f32 / fps).collect(),
        root_positions: positions.values.chunks_exact(3).map(Vec3::from_slice).collect(),
        local_rotations: rotations.values.chunks_exact(4 * count).map(frame).collect(),
    })
}

/// The pickle behind the header of an array of one Python object.
fn payload(bytes: &[u8]) -> Result<&[u8], String> {
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or("expected a numpy file")?;
    let (length, start): (usize, usize) = match rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 4),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
        _ => return Err("expected version 1, 2 or 3 of the numpy format".into()),
    };
    let end = start.checked_add(length).filter(|e| *e <= rest.len()).ok_or("expected a whole header")?;
    // `end` is inside, and not before `start`.
    let header = String::from_utf8_lossy(&rest[start..end]);
    if !header.contains("|O") {
        return Err(format!("expected an array of Python objects, found the header {}", header.trim()));
    }
    Ok(&rest[end..])
}

/// The dictionary in an array of one object.
fn dictionary(pickle: &Pickle, root: Id) -> Result<Id, String> {
    let wrong = || "expected an array of one dictionary".to_owned();
    let Object::Call { state: Some(state), .. } = pickle.object(root) else { return Err(wrong()) };
    let Object::Sequence(parts) = pickle.object(*state) else { return Err(wrong()) };
    let Some(Object::Sequence(items)) = parts.last().map(|id| pickle.object(*id)) else {
        return Err(wrong());
    };
    items.first().copied().ok_or_else(wrong)
}

/// An array of numbers.
struct Numbers {
    shape: Vec<usize>,
    values: Vec<f32>,
}

/// A pickled numpy array: its state is version, shape, type, order and bytes.
fn array(pickle: &Pickle, id: Id) -> Result<Numbers, String> {
    let wrong = || "expected a numpy array of numbers".to_owned();
    let Object::Call { state: Some(state), .. } = pickle.object(id) else { return Err(wrong()) };
    let Object::Sequence(parts) = pickle.object(*state) else { return Err(wrong()) };
    let [_, shape, kind, fortran, data] = parts[..] else { return Err(wrong()) };
    let (Object::Sequence(shape), Object::Bytes(data)) = (pickle.object(shape), pickle.object(data)) else {
        return Err(wrong());
    };
    if pickle.object(fortran) != &Object::Bool(false) {
        return Err("expected rows first, found columns first".into());
    }
    let mut sizes = Vec::with_capacity(shape.len());
    for id in shape {
        match pickle.object(*id) {
            Object::Int(size @ 0..=1_000_000) => sizes.push(*size as usize),
            other => return Err(format!("expected a size of at most 1000000, found {other:?}")),
        }
    }
    let width = match type_name(pickle, kind).as_deref() {
        Some("f4") => 4,
        Some("f8") => 8,
        other => return Err(format!("expected numbers of type f4 or f8, found {other:?}")),
    };
    let count = sizes.iter().try_fold(width, |a: usize, b| a.checked_mul(*b));
    if count != Some(data.len()) {
        return Err(format!("expected {width} bytes for each of {sizes:?}, found {}", data.len()));
    }
    let number = |b: &[u8]| match *b {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
        _ => f32::NAN,
    };
    Ok(Numbers { shape: sizes, values: data.chunks_exact(width).map(number).collect() })
}

/// First argument of a `dtype` call, such as `f4`.
fn type_name(pickle: &Pickle, id: Id) -> Option<String> {
    let Object::Call { arguments, .. } = pickle.object(id) else { return None };
    let Object::Sequence(arguments) = pickle.object(*arguments) else { return None };
    match pickle.object(*arguments.first()?) {
        Object::Text(name) => Some(name.clone()),
        Object::Bytes(name) => String::from_utf8(name.clone()).ok(),
        _ => None,
    }
}

#[cfg(test)]
#[path = "npy_tests.rs"]
mod tests;
