//! One character's evaluation of its blend: the three blend modes, and the cache of a blend that rests.

use crate::blend::Blend;
use crate::kernel::Arithmetic;
use crate::mlp::{Mlp, MlpScratch};

/// Evaluations that a blend rests before its parameters are cached: building them costs about four evaluations.
const RESTING_TICKS: u32 = 4;

/// How a blend of policies becomes one action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BlendMode {
    /// Interpolate the parameters: the paper's method.
    #[default]
    Parameters,
    /// Evaluate every policy and interpolate their actions.
    Actions,
    /// The policy with the greatest blend weight alone.
    Switch,
}

impl BlendMode {
    /// All modes, in the order of the paper's comparison.
    pub const ALL: [BlendMode; 3] = [BlendMode::Parameters, BlendMode::Actions, BlendMode::Switch];

    /// Name for command lines and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            BlendMode::Parameters => "parameters",
            BlendMode::Actions => "actions",
            BlendMode::Switch => "switch",
        }
    }

    /// The mode called `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }
}

/// What an evaluation took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Evaluation {
    /// One policy.
    #[default]
    Single,
    /// Interpolated parameters, cached in an earlier tick: one product.
    Cached,
    /// Interpolated parameters without building them: one product for each policy.
    Fused,
    /// Every policy, actions interpolated.
    Actions,
}

/// The last blend of parameters and how many evaluations it has rested. Whether the next evaluation is fused or cached,
/// which agree to rounding only, depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BlendRest {
    pub(crate) last: Blend,
    pub(crate) rested: u32,
}

/// Room and cache for the evaluations of one character.
#[derive(Clone, Debug)]
pub struct BlendEvaluator {
    arithmetic: Arithmetic,
    scratch: MlpScratch,
    cache: Option<Mlp>,
    rest: BlendRest,
}

impl BlendEvaluator {
    /// An evaluator for policies of one shape. With `cache` it holds the parameters of a resting blend, as
    /// large as one policy; a crowd that shares its processor cache may be faster without.
    #[must_use]
    pub fn new(shape: &Mlp, arithmetic: Arithmetic, cache: bool) -> Self {
        Self {
            arithmetic,
            scratch: MlpScratch::for_mlp(shape),
            cache: cache.then(|| shape.clone()),
            rest: BlendRest::default(),
        }
    }

    pub(crate) fn rest(&self) -> &BlendRest {
        &self.rest
    }

    /// Goes on where an evaluator with this rest stood: builds the cached parameters again where they differ. Does not
    /// allocate. The blend must be empty or of these policies.
    pub(crate) fn set_rest(&mut self, rest: BlendRest, policies: &[Mlp]) {
        let built = |rest: &BlendRest| rest.rested >= RESTING_TICKS;
        let same = built(&self.rest) && self.rest.last == rest.last;
        if let (Some(cache), true, false) = (&mut self.cache, built(&rest), same) {
            rest.last.parameters_into(policies, cache);
        }
        self.rest = rest;
    }

    /// Writes the action of a blend to `out`. Does not allocate. Fused and cached evaluation agree to
    /// rounding.
    ///
    /// # Panics
    /// As [`Blend::evaluate_into`].
    pub fn evaluate_into(
        &mut self,
        policies: &[Mlp],
        blend: &Blend,
        mode: BlendMode,
        input: &[f32],
        out: &mut [f32],
    ) -> Evaluation {
        let single = match mode {
            BlendMode::Switch => blend.strongest(),
            BlendMode::Parameters | BlendMode::Actions => blend.as_single(),
        };
        if let Some(policy) = single {
            policies[policy.index()].evaluate_into(self.arithmetic, input, &mut self.scratch, out);
            return Evaluation::Single;
        }
        if mode == BlendMode::Actions {
            blend.evaluate_actions_into(policies, self.arithmetic, input, &mut self.scratch, out);
            return Evaluation::Actions;
        }
        let BlendRest { last, rested } = &mut self.rest;
        *rested = if last == blend { rested.saturating_add(1) } else { 0 };
        *last = *blend;
        match &mut self.cache {
            Some(cache) if *rested >= RESTING_TICKS => {
                if *rested == RESTING_TICKS {
                    blend.parameters_into(policies, cache);
                }
                cache.evaluate_into(self.arithmetic, input, &mut self.scratch, out);
                Evaluation::Cached
            }
            _ => {
                blend.evaluate_into(policies, self.arithmetic, input, &mut self.scratch, out);
                Evaluation::Fused
            }
        }
    }
}
