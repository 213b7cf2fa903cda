use super::*;

/// The pickle that numpy would write, by hand: protocol 3, opcodes in the order of `pickletools`.
fn file(frames: usize, kind: &str) -> Vec<u8> {
    let mut p = vec![0x80, 3];
    let global = |p: &mut Vec<u8>, module: &str, name: &str| {
        p.push(b'c');
        p.extend(format!("{module}\n{name}\n").into_bytes());
    };
    let text = |p: &mut Vec<u8>, t: &str| {
        p.push(b'X');
        p.extend(u32::try_from(t.len()).unwrap().to_le_bytes());
        p.extend(t.as_bytes());
    };
    let reconstruct = |p: &mut Vec<u8>| {
        global(p, "numpy.core.multiarray", "_reconstruct");
        global(p, "numpy", "ndarray");
        p.extend([b'K', 0, 0x85, b'C', 1, b'b', 0x87, b'R']);
    };
    let dtype = |p: &mut Vec<u8>, kind: &str| {
        global(p, "numpy", "dtype");
        text(p, kind);
        p.extend([b'K', 0, b'K', 1, 0x87, b'R']);
        // Its state: (3, '<', None, None, None, -1, -1, 0)
        p.extend([b'(', b'K', 3]);
        text(p, "<");
        p.extend([b'N', b'N', b'N', b'J', 255, 255, 255, 255, b'J', 255, 255, 255, 255, b'K', 0, b't', b'b']);
    };
    let array = |p: &mut Vec<u8>, shape: &[u8], values: &[f32]| {
        reconstruct(p);
        p.extend([b'(', b'K', 1, b'(']);
        shape.iter().for_each(|s| p.extend([b'K', *s]));
        p.push(b't');
        dtype(p, kind);
        p.extend([0x89, b'B']);
        p.extend(u32::try_from(values.len() * 4).unwrap().to_le_bytes());
        values.iter().for_each(|v| p.extend(v.to_le_bytes()));
        p.extend([b't', b'b']);
    };
    reconstruct(&mut p);
    p.extend([b'(', b'K', 1, b')']);
    dtype(&mut p, "O8");
    p.extend([0x89, b']']);
    global(&mut p, "collections", "OrderedDict");
    p.extend([b')', b'R', b'(']);
    text(&mut p, "rotation");
    p.extend([b'}', b'(']);
    text(&mut p, "arr");
    let rotations: Vec<f32> = [0.0, 0.0, 0.0, 1.0].repeat(15 * frames);
    array(&mut p, &[frames as u8, 15, 4], &rotations);
    p.push(b'u');
    text(&mut p, "root_translation");
    p.extend([b'}', b'(']);
    text(&mut p, "arr");
    array(&mut p, &[frames as u8, 3], &[0.5, 0.0, 0.9].repeat(frames));
    p.push(b'u');
    text(&mut p, "fps");
    p.extend([b'K', 30, b'u', b'a', b't', b'b', b'.']);
    let header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }\n";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(p);
    bytes
}

#[test]
fn a_pickled_clip_is_read() {
    let clip = parse("amp", &file(4, "f4")).unwrap();
    assert_eq!(clip.times.len(), 4);
    assert!((clip.duration() - 0.1).abs() < 1e-6);
    assert_eq!(clip.root_positions[3], Vec3::new(0.5, 0.0, 0.9));
    assert_eq!(clip.local_rotations[2][14], Quat::IDENTITY);
}

#[test]
fn hostile_files_are_refused() {
    let good = file(4, "f4");
    for len in 0..good.len() {
        assert!(parse("cut", &good[..len]).is_err(), "{len} bytes");
    }
    assert!(parse("type", &file(4, "i4")).is_err());
    assert!(parse("one frame", &file(1, "f4")).is_err());
    // Any single byte may be changed: an error or another clip, never a panic.
    for at in 0..good.len() {
        for value in [0, 0x28, 0x2e, 0x68, 0x75, 0xff] {
            let mut bad = good.clone();
            bad[at] = value;
            let _ = parse("changed", &bad);
        }
    }
}
