//! Checks a port to another engine or language against golden values: run its controller over the states and commands
//! of `tests/golden/port.json`, in order, and write the same JSON with its own values. Says what differs, and by how much.
//!
//! `cargo run -p policy-core --example check_port -- my_values.json`

use serde_json::Value;

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/port.json");

/// In the order in which they are computed: the first that differs is where to look.
const VALUES: [&str; 5] = ["observation", "blend", "policy_input", "action", "joint_targets"];

/// Two implementations in single precision agree within this.
const TOLERANCE: f64 = 1e-4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let own = std::env::args().nth(1).ok_or("expected the path of a JSON file with your values")?;
    let golden: Value = serde_json::from_str(&std::fs::read_to_string(GOLDEN)?)?;
    let own: Value = serde_json::from_str(&std::fs::read_to_string(own)?)?;
    let mut wrong = 0;
    for name in VALUES {
        let (mut worst, mut place) = (0.0, String::from("-"));
        for (index, tick) in golden["ticks"].as_array().ok_or("expected ticks")?.iter().enumerate() {
            let (mut expected, mut found) = (Vec::new(), Vec::new());
            numbers(&tick[name], &mut expected);
            numbers(&own["ticks"][index][name], &mut found);
            if expected.len() != found.len() {
                worst = f64::INFINITY;
                place = format!("tick {index}: expected {} numbers, found {}", expected.len(), found.len());
                break;
            }
            for (at, (expected, found)) in expected.iter().zip(&found).enumerate() {
                let difference = (expected - found).abs();
                if difference > worst {
                    worst = difference;
                    place = format!("tick {index}, number {at}: expected {expected}, found {found}");
                }
            }
        }
        let verdict = if worst <= TOLERANCE { "same" } else { "DIFFERS" };
        wrong += usize::from(worst > TOLERANCE);
        println!("{name:14} {verdict:8} by at most {worst:.1e}   {place}");
    }
    if wrong == 0 {
        Ok(())
    } else {
        Err(format!("{wrong} of {} kinds of values differ", VALUES.len()).into())
    }
}

/// All numbers in a value, in order.
fn numbers(value: &Value, out: &mut Vec<f64>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| numbers(item, out)),
        other => out.extend(other.as_f64()),
    }
}
