//! `trainer strip`: each skill of a pack beside its clip, as strips of figures.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Args;
use clips::ClipFolder;
use evaluation::strip::{Row, draw};
use evaluation::trial::TICK_SECS;
use evaluation::{STANCE_METRES, clip_states, pose_error, watch, watch_layers, watch_skill};
use files::write_atomically;
use physics::{Engine, Model};
use policy_core::{CharacterPack, CharacterState, NodeId, SkillId};
use trainer::recipe::Recipe;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    pack: PathBuf,
    /// Folder for one SVG a skill.
    #[arg(long, default_value = "docs/motions")]
    out: PathBuf,
    /// Figures of a strip.
    #[arg(long, default_value_t = 13)]
    figures: usize,
    /// Control ticks from figure to figure.
    #[arg(long, default_value_t = 3)]
    stride: usize,
}

/// Draws.
pub(crate) fn run(
    described: &physics_bridge::Model,
    recipes: &Path,
    clips: &ClipFolder,
    a: &Arguments,
) -> Result<()> {
    let model = &Model::new(described, Engine::Mujoco)?;
    let pack = Arc::new(super::load::pack(&a.pack)?);
    std::fs::create_dir_all(&a.out).with_context(|| format!("cannot make {}", a.out.display()))?;
    let span = a.figures.max(1) * a.stride.max(1);
    for (index, node) in pack.graph().nodes().iter().enumerate().filter(|(_, n)| n.speed_mps.is_some()) {
        let recipe = Recipe::load(&recipes.join(format!("{}.toml", node.name)))?;
        // A recipe of a node has a clip or more.
        let of_recipe = &recipe.clips[0];
        let (name, clip) = (&of_recipe.name, clip_states(described, &of_recipe.load(clips)?)?);
        let motion = watch(model, &pack, NodeId::new(index));
        if motion.len() < span {
            say(format_args!("{}: falls before it can be drawn", node.name))?;
            continue;
        }
        let clip: Vec<CharacterState> = clip.iter().cycle().take(span).cloned().collect();
        // The stretch of the motion that is in step with the clip.
        let at = |start: usize| pose_error(&motion[start..start + 1], &clip[..1]);
        let start = (0..=motion.len() - span).min_by(|x, y| at(*x).total_cmp(&at(*y))).unwrap_or(0);
        let figures = |states: &[CharacterState]| states.iter().step_by(a.stride.max(1)).cloned().collect();
        let rows = [
            Row { caption: format!("clip {name}"), states: figures(&clip), fixed: false },
            Row {
                caption: format!("policy {}", node.name),
                states: figures(&motion[start..start + span]),
                fixed: false,
            },
        ];
        write(model, &a.out, &node.name, &rows)?;
    }
    episodic_skills(model, &pack, recipes, clips, a)?;
    layers(model, &pack, a)
}

/// Each episodic skill, whole, beside its clips.
fn episodic_skills(
    model: &Model,
    pack: &Arc<CharacterPack>,
    recipes: &Path,
    clips: &ClipFolder,
    a: &Arguments,
) -> Result<()> {
    for (index, skill) in pack.skills().iter().enumerate() {
        // Two skills may share a policy, which has one recipe.
        let policy = &pack.manifest().policies[skill.policy.index()].name;
        let recipe = Recipe::load(&recipes.join(format!("{policy}.toml")))?;
        let raises = pack.recovery() == Some(SkillId::new(index));
        // One that raises the character has a clip for each side it may lie on.
        for (which, clip) in recipe.clips.iter().take(if raises { 2 } else { 1 }).enumerate() {
            let loaded = clip.load(clips)?;
            let states = clip_states(model.described(), &loaded)?;
            // Of a clip that loops there are two cycles.
            let states = if loaded.looping { &states[..states.len() / 2] } else { &states[..] };
            let motion = watch_skill(model, pack, SkillId::new(index), which == 0);
            let name = if raises { clip.name.clone() } else { skill.name.clone() };
            // The whole of a skill on the strip, whatever it takes.
            let figures = |states: &[CharacterState]| -> Vec<CharacterState> {
                let last = states.len().saturating_sub(1);
                (0..a.figures)
                    .filter_map(|i| states.get(i * last / a.figures.max(2).saturating_sub(1)))
                    .cloned()
                    .collect()
            };
            let secs = |states: &[CharacterState]| states.len() as f32 * TICK_SECS;
            let rows = [
                Row {
                    caption: format!("clip {}, {:.1} s", clip.name, secs(states)),
                    states: figures(states),
                    fixed: true,
                },
                Row {
                    caption: format!("policy {}, {:.1} s", skill.name, secs(&motion)),
                    states: figures(&motion),
                    fixed: true,
                },
            ];
            write(model, &a.out, &name, &rows)?;
        }
    }
    Ok(())
}

/// Single layers half-way from the second node of the first path to its third, and the policies at both ends.
fn layers(model: &Model, pack: &Arc<CharacterPack>, a: &Arguments) -> Result<()> {
    let nodes = pack.graph().paths().first().map(|path| path.nodes());
    let (Some(&[_, from, to, ..]), Some(&foot)) = (nodes, model.skeleton().feet().first()) else {
        return Ok(());
    };
    let names = [from, to].map(|node| &pack.graph().node(node).name);
    let mut rows = Vec::new();
    for (caption, t) in [
        (format!("{} alone", names[0]), [0.0; 3]),
        ("layer 1 half-way".into(), [0.5, 0.0, 0.0]),
        ("layer 2 half-way".into(), [0.0, 0.5, 0.0]),
        ("layer 3 half-way".into(), [0.0, 0.0, 0.5]),
        ("all layers half-way".into(), [0.5; 3]),
        (format!("{} alone", names[1]), [1.0; 3]),
    ] {
        let Some(states) = watch_layers(model, pack, (from, to), t) else {
            say(format_args!("{caption}: falls before it can be drawn"))?;
            continue;
        };
        // From a tick at which the first foot comes down, after 4 s.
        let height = |i: usize| states[i].body(foot).position.z;
        let start = (120..states.len().saturating_sub(a.figures * a.stride))
            .find(|i| height(i - 1) >= STANCE_METRES && height(*i) < STANCE_METRES)
            .unwrap_or(120);
        let states = states[start..].iter().step_by(a.stride.max(1)).take(a.figures).cloned().collect();
        rows.push(Row { caption, states, fixed: false });
    }
    write(model, &a.out, "layers", &rows)
}

fn write(model: &Model, folder: &Path, name: &str, rows: &[Row]) -> Result<()> {
    let path = folder.join(format!("{name}.svg"));
    write_atomically(&path, draw(model.skeleton(), rows).as_bytes())
        .with_context(|| format!("cannot write {}", path.display()))?;
    say(format_args!("wrote {}", path.display()))?;
    Ok(())
}
