//! A player: a gamepad or the keyboard becomes commands, through policy-core's mapper.
//!
//! Real gamepads need the feature `pads`, or Bevy's own `bevy_gilrs`. Without one the keys are: W A S D to walk, Shift faster, C lower,
//! Q another style, E roll, Space get up, F jump, G punch.

use core::hash::Hash;
use std::sync::Arc;

use bevy::prelude::*;
use policy_core::{
    Bindings, Button, CharacterPack, CharacterState, Command, CommandMapper, GamepadState, Heading,
};

use crate::axes;
use crate::character::{CharacterCommand, CharacterGoal, PolicyController};

/// Steers a character by gamepad or keyboard: writes its [`CharacterCommand`] in each frame.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct PlayerInput {
    /// The gamepad; `None` for all of them and the keyboard.
    #[entities]
    pub gamepad: Option<Entity>,
    /// The camera that "ahead" is meant for; `None`: ahead is -z.
    #[entities]
    pub camera: Option<Entity>,
    /// Which control does what.
    #[reflect(ignore)]
    pub bindings: Bindings,
}

/// The mapper of a player, and what it was made of: its ids are those of the pack.
#[derive(Component)]
struct PlayerMapper {
    mapper: CommandMapper,
    pack: Arc<CharacterPack>,
    bindings: Bindings,
    /// What the pad was like last, so that a new mapper takes no held button for one just pressed.
    last: GamepadState,
}

impl PlayerMapper {
    fn new(pack: &Arc<CharacterPack>, bindings: &Bindings) -> Self {
        Self {
            mapper: CommandMapper::new(pack, bindings),
            pack: Arc::clone(pack),
            bindings: bindings.clone(),
            last: GamepadState::default(),
        }
    }

    /// Makes the mapper anew when the pack or the bindings are others.
    fn follow(&mut self, pack: &Arc<CharacterPack>, bindings: &Bindings, state: &CharacterState) {
        if Arc::ptr_eq(&self.pack, pack) && self.bindings == *bindings {
            return;
        }
        let last = self.last;
        *self = Self::new(pack, bindings);
        self.map(&last, Heading::FORWARD, state);
    }

    fn map(&mut self, pad: &GamepadState, ahead: Heading, state: &CharacterState) -> Command {
        self.last = *pad;
        self.mapper.map(pad, ahead, state)
    }
}

/// Turns gamepads and keys into commands of characters with a [`PlayerInput`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PolicyInputPlugin;

impl Plugin for PolicyInputPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PlayerInput>().add_observer(forget).add_systems(
            RunFixedMainLoop,
            (make_mappers, command).chain().in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        );
    }
}

fn make_mappers(
    mut commands: Commands,
    mut players: Query<(Entity, Ref<PlayerInput>, &PolicyController, Option<&mut PlayerMapper>)>,
) {
    for (entity, input, controller, mapper) in &mut players {
        let pack = controller.controller.pack();
        match mapper {
            None => {
                commands.entity(entity).try_insert(PlayerMapper::new(pack, &input.bindings));
            }
            Some(mut mapper) if input.is_changed() || !Arc::ptr_eq(&mapper.pack, pack) => {
                mapper.follow(pack, &input.bindings, &controller.sensed);
            }
            Some(_) => {}
        }
    }
}

/// The mapper leaves with the controller.
fn forget(removed: On<Remove<PolicyController>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<PlayerMapper>();
}

fn command(
    mut players: Query<(&PlayerInput, &mut PlayerMapper, &PolicyController, &mut CharacterCommand)>,
    gamepads: Query<(Entity, &Gamepad)>,
    keys: Option<Res<ButtonInput<KeyCode>>>,
    places: TransformHelper,
) {
    for (input, mut mapper, controller, mut command) in &mut players {
        let mut pad = GamepadState::default();
        for (_, gamepad) in
            gamepads.iter().filter(|(entity, _)| input.gamepad.is_none_or(|own| own == *entity))
        {
            add_gamepad(&mut pad, gamepad);
        }
        if let (None, Some(keys)) = (input.gamepad, &keys) {
            add_keys(&mut pad, keys);
        }
        // Of this frame, with what the camera is a child of.
        let camera = input.camera.and_then(|camera| places.compute_global_transform(camera).ok());
        let ahead = camera.map_or(Heading::from_angle(core::f32::consts::FRAC_PI_2), |camera| {
            axes::heading_from_bevy(camera.rotation())
        });
        let wanted = mapper.map(&pad, ahead, &controller.sensed);
        let ground = controller.sensed.ground_height;
        command.target = wanted.target.map(|target| axes::to_bevy(target.extend(ground)));
        command.facing = wanted.facing.map(|facing| axes::to_bevy(facing.extend(0.0)));
        command.goal = CharacterGoal::Ids(wanted.goal);
        if let Some(skill) = wanted.skill.and_then(|skill| mapper.pack.skills().get(skill.index())) {
            command.skill = Some(skill.name.clone().into());
        }
    }
}

/// True for what is pressed, and for what was pressed and released within the frame.
fn is_held<T: Copy + Eq + Hash + Send + Sync + 'static>(buttons: &ButtonInput<T>, button: T) -> bool {
    buttons.pressed(button) || buttons.just_pressed(button)
}

/// Buttons of Bevy by place; policy-core names them alike, but for the triggers.
const BUTTONS: [(GamepadButton, Button); 16] = [
    (GamepadButton::South, Button::South),
    (GamepadButton::East, Button::East),
    (GamepadButton::West, Button::West),
    (GamepadButton::North, Button::North),
    (GamepadButton::LeftTrigger, Button::LeftShoulder),
    (GamepadButton::RightTrigger, Button::RightShoulder),
    (GamepadButton::LeftThumb, Button::LeftStick),
    (GamepadButton::RightThumb, Button::RightStick),
    (GamepadButton::Select, Button::Select),
    (GamepadButton::Start, Button::Start),
    (GamepadButton::Mode, Button::Guide),
    (GamepadButton::DPadUp, Button::DpadUp),
    (GamepadButton::DPadDown, Button::DpadDown),
    (GamepadButton::DPadLeft, Button::DpadLeft),
    (GamepadButton::DPadRight, Button::DpadRight),
    (GamepadButton::Other(0), Button::Misc),
];

fn add_gamepad(pad: &mut GamepadState, gamepad: &Gamepad) {
    let stick = |sum: [f32; 2], own: Vec2| (Vec2::from_array(sum) + own).to_array();
    pad.left_stick = stick(pad.left_stick, gamepad.left_stick());
    pad.right_stick = stick(pad.right_stick, gamepad.right_stick());
    let trigger = |button: GamepadButton| gamepad.get(button).unwrap_or(0.0);
    pad.left_trigger = pad.left_trigger.max(trigger(GamepadButton::LeftTrigger2));
    pad.right_trigger = pad.right_trigger.max(trigger(GamepadButton::RightTrigger2));
    for (own, button) in BUTTONS {
        if is_held(gamepad.digital(), own) {
            pad.buttons.set(button, true);
        }
    }
}

/// Keys that stand for buttons.
const KEYS: [(KeyCode, Button); 6] = [
    (KeyCode::Space, Button::South),
    (KeyCode::KeyE, Button::East),
    (KeyCode::KeyG, Button::West),
    (KeyCode::KeyF, Button::North),
    (KeyCode::KeyQ, Button::RightShoulder),
    (KeyCode::KeyR, Button::RightStick),
];

fn add_keys(pad: &mut GamepadState, keys: &ButtonInput<KeyCode>) {
    let pushed = |key| f32::from(u8::from(keys.pressed(key)));
    pad.left_stick[0] += pushed(KeyCode::KeyD) - pushed(KeyCode::KeyA);
    pad.left_stick[1] += pushed(KeyCode::KeyW) - pushed(KeyCode::KeyS);
    pad.right_trigger = pad.right_trigger.max(pushed(KeyCode::ShiftLeft));
    pad.left_trigger = pad.left_trigger.max(pushed(KeyCode::KeyC));
    for (key, button) in KEYS {
        if is_held(keys, key) {
            pad.buttons.set(button, true);
        }
    }
}
