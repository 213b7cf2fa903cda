//! Blend modes in a split screen: the same stick for all, falls counted, and the way back.

mod common;

use clap::Parser as _;
use common::{FORWARD, gpu, playground};
use policy_core::{BlendMode, Buttons, GamepadState};
use viewer::app::{App, PanelLayout, ViewerCommand};
use viewer::appearance;
use viewer::cli::{Cli, headless};
use viewer::frame_composer::FrameComposer;
use viewer::render::OffScreen;
use viewer::sim::{GhostKind, SHOVE_BUTTON, SceneKind};

fn compared() -> App {
    let mut app = App::new(playground(2), PanelLayout::default());
    app.apply(ViewerCommand::Mode(BlendMode::Actions));
    app.apply(ViewerCommand::Compare(true));
    app
}

fn run(app: &mut App, pad: GamepadState, ticks: usize) {
    app.pad.state = pad;
    for _ in 0..ticks {
        assert!(app.tick().is_empty());
        app.follow(app.sim.tick_secs(), 1.0);
    }
}

#[test]
fn each_mode_has_a_character_under_the_same_stick_and_its_falls_count() {
    let mut app = compared();
    let modes: Vec<BlendMode> = app.sim.characters().iter().map(|c| c.blend_mode()).collect();
    assert_eq!((modes.as_slice(), app.views()), (BlendMode::ALL.as_slice(), BlendMode::ALL.len()));
    let starts: Vec<_> = app.sim.characters().iter().map(|c| c.position()).collect();
    assert!(starts.iter().all(|at| at.length() < 0.01), "{starts:?}");
    run(&mut app, FORWARD, 90);
    let walked: Vec<f32> = app.sim.characters().iter().map(|c| c.position().x).collect();
    assert!(walked.iter().all(|&x| x > 0.5), "{walked:?}");
    let before: Vec<u32> = app.sim.characters().iter().map(|c| c.falls()).collect();
    run(&mut app, GamepadState::default(), 30);
    run(&mut app, GamepadState { buttons: Buttons::NONE.with(SHOVE_BUTTON), ..GamepadState::default() }, 1);
    run(&mut app, GamepadState::default(), 60);
    for (character, before) in app.sim.characters().iter().zip(before) {
        assert!(character.falls() > before, "{:?} was knocked over", character.blend_mode());
    }
    app.apply(ViewerCommand::Reset);
    assert!(app.sim.characters().iter().all(|c| c.falls() == 0 && c.position().length() < 0.01));
}

#[test]
fn it_ends_where_it_began_and_refuses_what_has_no_sense_in_it() {
    let mut app = compared();
    let config = *app.sim.config();
    app.apply(ViewerCommand::Mode(BlendMode::Switch));
    assert!(app.toasts.take_text().unwrap().contains("end the comparison"));
    app.apply(ViewerCommand::Ghost(Some(GhostKind::Mode(BlendMode::Switch))));
    assert!(app.sim.ghost().is_none());
    assert_eq!(*app.sim.config(), config);
    app.apply(ViewerCommand::Compare(false));
    assert_eq!(app.views(), 1);
    assert_eq!((app.sim.config().scene, app.sim.characters().len()), (SceneKind::Playground, 2));
    assert!(app.sim.characters().iter().all(|c| c.blend_mode() == BlendMode::Actions));
    // Another scene, or another number of characters, ends it too.
    app.apply(ViewerCommand::Compare(true));
    app.apply(ViewerCommand::Scene(SceneKind::Playground));
    assert_eq!((app.views(), app.sim.config().scene), (1, SceneKind::Playground));
    app.apply(ViewerCommand::Compare(true));
    app.apply(ViewerCommand::Characters(4));
    assert_eq!((app.views(), app.sim.characters().len()), (1, 4));
}

#[test]
fn every_view_shows_its_character_and_no_other() {
    let Some(gpu) = gpu() else { return };
    const SIZE: [u32; 2] = [600, 200];
    let mut app = compared();
    run(&mut app, FORWARD, 60);
    let (look, _) = appearance::of_pack(app.sim.pack(), app.sim.model());
    let mut composer = FrameComposer::new(&gpu, OffScreen::FORMAT, look);
    let size = egui::vec2(SIZE[0] as f32, SIZE[1] as f32);
    let input = || egui::RawInput {
        screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
        ..Default::default()
    };
    let output = composer.panels(&mut app, input());
    let picture = composer.picture(&mut app, output, SIZE, false).unwrap();
    // White limbs, in each third and about its middle alone.
    let light = |x: u32| {
        let bright = |y: u32| picture.get_pixel(x, y).0[..3].iter().all(|&c| c > 170);
        (60..170).filter(|&y| bright(y)).count()
    };
    for view in 0..3 {
        let third = 200 * view..200 * (view + 1);
        let middle: usize = third.clone().skip(70).take(60).map(light).sum();
        assert!(middle > 50, "view {view} has {middle} light pixels in its middle");
        let aside: usize = third.clone().take(40).chain(third.skip(160)).map(light).sum();
        assert!(aside < middle / 4, "view {view}: {aside} beside, {middle} in the middle");
    }
}

#[test]
fn a_run_without_a_window_reports_the_falls_of_each_mode() {
    let words = ["policy-space", "--headless", "--compare", "--seconds", "1"];
    let report = headless::run(&Cli::parse_from(words).demo).unwrap();
    let modes: Vec<&str> = report.comparison.iter().map(|compared| compared.mode).collect();
    assert_eq!(modes, BlendMode::ALL.map(BlendMode::name));
    assert!(Cli::try_parse_from([&words[..], &["--mode", "switch"]].concat()).is_err());
}
