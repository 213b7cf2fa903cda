//! Makes a hostile file out of a sound one: what a broken disk, a careless editor or an attacker would leave.
//!
//! The format is found by its content, never by the name of the reader. Every case is a function of its random
//! numbers alone, so that a case can be made again.

use serde_json::Value;

use super::json;
use super::random::Random;
use super::text;

/// Longest file that is made, bytes.
const MOST_BYTES: usize = 16 << 20;

/// A hostile version of `sound`. `other` is a second sound file of the same reader, to splice with.
pub fn mutated(sound: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    // Mostly one fault: two often hide each other.
    for _ in 0..=random.below(8) / 6 {
        bytes = once(&bytes, other, random);
    }
    bytes.truncate(MOST_BYTES);
    bytes
}

fn once(bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    if random.below(4) > 0
        && let Some(changed) = structured(bytes, random)
    {
        return changed;
    }
    binary(bytes, other, random)
}

/// A change that keeps the file's frame sound, so that it gets past the first check.
fn structured(bytes: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    if let Some((header, rest)) = split_safetensors(bytes) {
        let header = json::mutated(&header, random).to_string();
        let length = (header.len() as u64).to_le_bytes();
        return Some([&length[..], header.as_bytes(), rest].concat());
    }
    if let Some((header, rest)) = split_glb(bytes) {
        return Some(join_glb(&json::mutated(&header, random).to_string(), rest));
    }
    let words = std::str::from_utf8(bytes).ok()?;
    if random.below(2) == 0
        && let Ok(value) = serde_json::from_str::<Value>(words)
    {
        return Some(json::mutated(&value, random).to_string().into_bytes());
    }
    Some(text::mutated(words, random).into_bytes())
}

/// Longest file of a flood, bytes: more than most readers take.
const FLOOD_BYTES: usize = 48 << 20;

/// `sound` with something small repeated until the file is as long as a reader may take: what is cheap to write and dear
/// to keep. It goes into a list where the file has one.
pub fn flooded(sound: &[u8], random: &mut Random) -> Vec<u8> {
    let drop = random.one_of(&["[],", "{},", "0,", "\"\",", "[[]],", "{\"a\":[]},"]);
    if let Some((header, rest)) = split_safetensors(sound) {
        let header = flooded_text(&header.to_string(), drop, random);
        return [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), rest].concat();
    }
    if let Some((header, rest)) = split_glb(sound) {
        return join_glb(&flooded_text(&header.to_string(), drop, random), rest);
    }
    match std::str::from_utf8(sound) {
        Ok(words) => flooded_text(words, drop, random).into_bytes(),
        Err(_) => {
            let at = random.below(sound.len());
            let piece = &sound[at..(at + 1 + random.below(32)).min(sound.len())];
            let flood = piece.repeat(FLOOD_BYTES / piece.len());
            [&sound[..at], &flood, &sound[at..]].concat()
        }
    }
}

fn flooded_text(words: &str, drop: &str, random: &mut Random) -> String {
    let lists: Vec<usize> = words.match_indices('[').map(|(at, _)| at + 1).collect();
    let mut at = if lists.is_empty() { words.len() } else { lists[random.below(lists.len())] };
    while !words.is_char_boundary(at) {
        at -= 1;
    }
    // In a text inside a text a quotation mark is escaped; the others need no care.
    let drop =
        if words[..at].matches("\\\"").count() > 0 { drop.replace('"', "\\\"") } else { drop.to_owned() };
    [&words[..at], &drop.repeat(FLOOD_BYTES / drop.len()), &words[at..]].concat()
}

/// The JSON header of a safetensors file and the bytes of its tensors.
fn split_safetensors(bytes: &[u8]) -> Option<(Value, &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let header: Value = serde_json::from_slice(rest.get(..length)?).ok()?;
    header.is_object().then_some((header, &rest[length..]))
}

/// The JSON chunk of a glTF binary and the chunks behind it.
fn split_glb(bytes: &[u8]) -> Option<(Value, &[u8])> {
    let rest = bytes.strip_prefix(b"glTF")?.get(8..)?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let length = u32::from_le_bytes(*length) as usize;
    let chunk = rest.strip_prefix(b"JSON")?;
    Some((serde_json::from_slice(chunk.get(..length)?).ok()?, &chunk[length..]))
}

/// A glTF binary around a JSON chunk; every length is right.
fn join_glb(header: &str, rest: &[u8]) -> Vec<u8> {
    let padding = header.len().next_multiple_of(4) - header.len();
    let length = header.len() + padding;
    let whole = (20 + length + rest.len()) as u32;
    let mut bytes = [&b"glTF"[..], &2u32.to_le_bytes(), &whole.to_le_bytes()].concat();
    bytes.extend((length as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(header.as_bytes());
    bytes.extend(std::iter::repeat_n(b' ', padding));
    bytes.extend(rest);
    bytes
}

/// A change that knows nothing of the format.
fn binary(bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut out = bytes.to_vec();
    // Headers are short and matter more than what follows.
    let window = if random.below(2) == 0 { out.len().min(256) } else { out.len() };
    let at = random.below(window.max(1));
    let run = (at..(at + 1 + random.below(64)).min(out.len())).collect::<Vec<_>>();
    match random.below(9) {
        0 => flip(&mut out, at, random),
        1 => (0..8).for_each(|_| {
            let at = random.below(out.len().max(1));
            flip(&mut out, at, random);
        }),
        2 => out.truncate(at),
        3 => out.extend(&bytes[..bytes.len().min(1 << 16)]),
        4 => huge(&mut out, at, random),
        5 => run.iter().for_each(|&i| out[i] = 0),
        6 => drop(out.splice(at.min(bytes.len()).., other.iter().copied().skip(at))),
        7 => drop(out.drain(run.first().copied().unwrap_or(0)..run.last().map_or(0, |last| last + 1))),
        _ => run.iter().for_each(|&i| out[i] = random.below(256) as u8),
    }
    out
}

fn flip(bytes: &mut [u8], at: usize, random: &mut Random) {
    if let Some(byte) = bytes.get_mut(at) {
        *byte ^= 1 << random.below(8);
    }
}

/// Overwrites what may be a length with a number that no file has room for.
fn huge(bytes: &mut [u8], at: usize, random: &mut Random) {
    const LENGTHS: [u64; 8] =
        [u64::MAX, 1 << 63, u32::MAX as u64, 1 << 31, 0x7fff_ffff, 1 << 40, 100_000_000, 0x7fc0_0000];
    let number = random.one_of(&LENGTHS).to_le_bytes();
    let width = random.one_of(&[2, 4, 8]);
    for (byte, digit) in bytes.iter_mut().skip(at).zip(&number[..width]) {
        *byte = *digit;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn safetensors() -> Vec<u8> {
        let header = r#"{"__metadata__":{"inner":"{\"version\":1}"},"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}}"#;
        [&(header.len() as u64).to_le_bytes()[..], header.as_bytes(), &[0; 8]].concat()
    }

    #[test]
    fn the_same_numbers_make_the_same_case() {
        let sound = safetensors();
        for case in 0..40 {
            let make = || mutated(&sound, b"other", &mut Random::new(case));
            assert_eq!(make(), make(), "case {case}");
        }
    }

    #[test]
    fn a_flood_keeps_the_frame_and_is_as_long_as_it_may_be() {
        for sound in [safetensors(), join_glb("{\"a\":[1]}", &[0; 8]), b"a = [1]".to_vec(), vec![200; 30]] {
            let flood = flooded(&sound, &mut Random::new(3));
            assert!((FLOOD_BYTES / 2..2 * FLOOD_BYTES).contains(&flood.len()), "{} bytes", flood.len());
            assert_eq!(sound.starts_with(b"glTF"), flood.starts_with(b"glTF"));
        }
    }

    #[test]
    fn most_cases_differ_from_the_sound_file() {
        for sound in
            [safetensors(), b"a = 1\nb = \"two\"\n".to_vec(), vec![7; 300], br#"{"a":[1,2]}"#.to_vec()]
        {
            let changed = |case| mutated(&sound, b"other", &mut Random::new(case)) != sound;
            let count = (0..50).filter(|case| changed(*case)).count();
            assert!(count > 40, "{count} of 50 differ");
        }
    }

    #[test]
    fn nothing_is_needed_of_the_sound_file() {
        for case in 0..100 {
            mutated(b"", b"", &mut Random::new(case));
            mutated(b"x", b"", &mut Random::new(case));
        }
    }

    #[test]
    fn a_structured_change_keeps_the_frames_of_containers() {
        let sound = safetensors();
        let glb = join_glb(r#"{"asset":{"version":"2.0"}}"#, &[0; 8]);
        assert_eq!(split_glb(&glb).unwrap().0["asset"]["version"], "2.0");
        for case in 0..30 {
            let changed = structured(&sound, &mut Random::new(case)).unwrap();
            assert!(split_safetensors(&changed).is_some(), "case {case}");
            let changed = structured(&glb, &mut Random::new(case)).unwrap();
            assert!(split_glb(&changed).is_some(), "case {case}");
            assert_eq!(u32::from_le_bytes(changed[8..12].try_into().unwrap()) as usize, changed.len());
        }
    }
}
