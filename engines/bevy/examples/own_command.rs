//! A command of a game's own: the character patrols, crouches in the middle of its way, and rolls when Space is pressed.
//!
//! `cargo run --release --features window --example own_command`

mod scene;

use bevy::prelude::*;
use bevy_policy_space::BodyMeshes;
use bevy_policy_space::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        // Commands are read in the fixed schedule; those made there are acted on in the same step.
        .add_systems(FixedUpdate, patrol.before(PolicySpaceSystems::Decide))
        .add_systems(Update, (roll, print_skills))
        .run();
}

/// The game's own component.
#[derive(Component)]
struct Patrol {
    points: [Vec3; 2],
    next: usize,
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((
        PolicyCharacter::new(assets.load(scene::PACK)),
        Patrol { points: [Vec3::new(0.0, 0.0, -6.0), Vec3::new(0.0, 0.0, 6.0)], next: 0 },
        BodyMeshes::default(),
        scene::Followed,
    ));
}

fn patrol(mut patrols: Query<(&Transform, &mut Patrol, &mut CharacterCommand)>) {
    for (place, mut patrol, mut command) in &mut patrols {
        if place.translation.distance(patrol.points[patrol.next]) < 1.0 {
            patrol.next = 1 - patrol.next;
        }
        command.target = Some(patrol.points[patrol.next]);
        let low = place.translation.z.abs() < 1.5;
        let (path, coordinate) = if low { ("stance", 1.0) } else { ("speed", 1.0) };
        command.goal = CharacterGoal::Path { path: path.into(), coordinate };
    }
}

fn roll(keys: Res<ButtonInput<KeyCode>>, mut commands: Query<&mut CharacterCommand>) {
    if keys.just_pressed(KeyCode::Space) {
        for mut command in &mut commands {
            command.skill = Some("roll".into());
        }
    }
}

fn print_skills(mut started: MessageReader<SkillStarted>, mut ended: MessageReader<SkillEnded>) {
    for skill in started.read() {
        info!("{} starts", skill.name);
    }
    for skill in ended.read() {
        info!("{} ended: {:?}", skill.name, skill.end);
    }
}
