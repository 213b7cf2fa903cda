//! A recipe, a plan of a pack or a lineage made of anything: refused, or every number of it is in its range.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use trainer::lineage::Lineage;
use trainer::recipe::Recipe;

fuzz_target!(|text: &str| {
    let path = Path::new("recipes/fuzz.toml");
    // Characters are files beside the recipe; there are none.
    if let Ok(mut recipe) = Recipe::parse(path, text) {
        for samples in [0, 1, recipe.total_samples(), u64::MAX] {
            assert!(recipe.phase_at(samples) < recipe.phases.len());
        }
        let _ = (recipe.first(), recipe.last());
        recipe.stop_at(1000);
        assert!(recipe.total_samples() <= 1000);
    }
    let _ = Lineage::parse(path, text);
});
