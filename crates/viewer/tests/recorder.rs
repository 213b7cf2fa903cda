//! What the recorder writes can be read again: pictures, an animation, a film.

use std::path::Path;
use std::process::Command;

use image::{Rgba, RgbaImage};
use viewer::recorder::{Kind, Recorder};

const SIZE: [u32; 2] = [64, 48];
const FRAMES: u32 = 6;

/// A square that moves; the fourth picture comes from a resized window.
fn record(kind: Kind, path: &Path) {
    let mut recorder = Recorder::start(kind, path.to_owned(), SIZE, 10);
    for frame in 0..FRAMES {
        let scale = if frame == 3 { 2 } else { 1 };
        let square = |x: u32, y: u32| (8 * frame..8 * frame + 8).contains(&(x / scale)) && y / scale < 8;
        let picture = RgbaImage::from_fn(SIZE[0] * scale, SIZE[1] * scale, |x, y| match square(x, y) {
            true => Rgba([255, 0, 0, 255]),
            false => Rgba([0, 0, 255, 255]),
        });
        assert!(recorder.take(picture, frame));
    }
    assert_eq!(recorder.finish().unwrap(), 0, "nothing was dropped");
}

#[test]
fn a_sequence_holds_every_picture_in_one_size() {
    let folder = tempfile::tempdir().unwrap();
    record(Kind::Sequence, folder.path());
    for frame in 0..FRAMES {
        let picture = image::open(folder.path().join(format!("frame_{frame:05}.png"))).unwrap().to_rgba8();
        assert_eq!(picture.dimensions(), (SIZE[0], SIZE[1]));
        let red = picture.get_pixel(8 * frame + 3, 3);
        assert!(red[0] > 250 && red[2] < 5, "picture {frame}: {red:?}");
    }
}

#[test]
fn an_animation_holds_every_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.apng");
    record(Kind::Apng, &path);
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let reader = decoder.read_info().unwrap();
    let animation = reader.info().animation_control().unwrap();
    assert_eq!((animation.num_frames, reader.info().width, reader.info().height), (FRAMES, SIZE[0], SIZE[1]));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no parts are left");
}

#[test]
fn an_animation_is_not_called_a_picture_and_recordings_stay_out_of_the_repository() {
    assert_eq!([Kind::Sequence, Kind::Mp4, Kind::Apng].map(Kind::extension), ["frames", "mp4", "apng"]);
    let ignored = include_str!("../../../.gitignore");
    assert!(ignored.lines().any(|line| line == "/policy-space-recordings"), "{ignored}");
}

#[test]
fn a_film_is_one_that_ffmpeg_reads() {
    if Kind::film() != Kind::Mp4 {
        eprintln!("skipped: ffmpeg is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    record(Kind::Mp4, &path);
    let frames = folder.path().join("%03d.png");
    let read =
        Command::new("ffmpeg").args(["-loglevel", "error", "-i"]).arg(&path).arg(&frames).status().unwrap();
    assert!(read.success());
    let picture = image::open(folder.path().join("001.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (SIZE[0], SIZE[1]));
    let blue = picture.get_pixel(40, 40);
    assert!(blue[2] > 200 && blue[0] < 60, "{blue:?}");
}

#[test]
fn an_animation_shows_each_picture_as_long_as_the_demo_did() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.apng");
    let mut recorder = Recorder::start(Kind::Apng, path.clone(), SIZE, 30);
    // A slow machine: the second picture comes a third of a second after the first.
    for at in [0, 10, 12, 13] {
        assert!(recorder.take(RgbaImage::new(SIZE[0], SIZE[1]), at));
    }
    recorder.finish().unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let shown: Vec<[u16; 2]> = (0..4)
        .map(|_| {
            reader.next_frame(&mut bytes).unwrap();
            let control = reader.info().frame_control.unwrap();
            [control.delay_num, control.delay_den]
        })
        .collect();
    assert_eq!(shown, [[10, 30], [2, 30], [1, 30], [1, 30]]);
}

#[test]
fn a_film_that_cannot_be_written_is_an_error_with_the_words_of_ffmpeg() {
    if Kind::film() != Kind::Mp4 {
        eprintln!("skipped: ffmpeg is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    // A film of no width: ffmpeg refuses it.
    let mut recorder = Recorder::start(Kind::Mp4, path.clone(), [0, 0], 10);
    recorder.take(RgbaImage::new(0, 0), 0);
    let said = recorder.finish().unwrap_err().to_string();
    assert!(said.starts_with("ffmpeg failed on") && said.len() > path.as_os_str().len() + 25, "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "no part is left");
}
