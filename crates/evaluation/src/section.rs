//! The parts of an evaluation, to measure all of them or some.

/// A part of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Section {
    /// Survival and speed along each path, on flat and uneven ground.
    Paths,
    /// Turns with each policy by itself.
    Upright,
    /// Pushes on the pelvis with each policy by itself.
    Push,
    /// Pose error, steps, stance.
    Motion,
    /// Interpolation of single layers.
    Layers,
    /// Episodic skills.
    Skills,
    /// Turns by the stick.
    Turns,
    /// Starts by the stick.
    Starts,
    /// Stops by the stick.
    Stops,
    /// Drift and speed straight ahead.
    Straight,
    /// Facing one way and moving another.
    Strafe,
    /// From a crawl to its feet.
    Rise,
    /// Presses of every button in every gait.
    Buttons,
    /// Jumps of joint targets at the start and end of a skill.
    Jumps,
    /// Feet that slide, legs inside each other.
    Legs,
    /// A pad at random.
    RandomPad,
    /// Uneven ground in every gait.
    Terrain,
    /// Getting up on uneven ground.
    GetUp,
    /// A body and a world that differ from training.
    Robustness,
    /// Pushes from four sides on torso and pelvis.
    Pushes,
    /// Others, balls, crates, a door and stairs in a shared world.
    Encounters,
    /// The playground's course.
    Race,
}

impl Section {
    /// All sections, in the order in which they are measured.
    pub const ALL: [Section; 22] = [
        Section::Paths,
        Section::Upright,
        Section::Push,
        Section::Motion,
        Section::Layers,
        Section::Skills,
        Section::Turns,
        Section::Starts,
        Section::Stops,
        Section::Straight,
        Section::Strafe,
        Section::Rise,
        Section::Buttons,
        Section::Jumps,
        Section::Legs,
        Section::RandomPad,
        Section::Terrain,
        Section::GetUp,
        Section::Robustness,
        Section::Pushes,
        Section::Encounters,
        Section::Race,
    ];

    /// Name for command lines.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Section::Paths => "paths",
            Section::Upright => "upright",
            Section::Push => "push",
            Section::Motion => "motion",
            Section::Layers => "layers",
            Section::Skills => "skills",
            Section::Turns => "turns",
            Section::Starts => "starts",
            Section::Stops => "stops",
            Section::Straight => "straight",
            Section::Strafe => "strafe",
            Section::Rise => "rise",
            Section::Buttons => "buttons",
            Section::Jumps => "jumps",
            Section::Legs => "legs",
            Section::RandomPad => "random_pad",
            Section::Terrain => "terrain",
            Section::GetUp => "get_up",
            Section::Robustness => "robustness",
            Section::Pushes => "pushes",
            Section::Encounters => "encounters",
            Section::Race => "race",
        }
    }

    /// The section called `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Section> {
        Section::ALL.into_iter().find(|section| section.name() == name)
    }
}
