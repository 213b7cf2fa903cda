//! Changes one place in a JSON document: removes, retypes, swaps, enlarges.
//!
//! A text that is itself JSON (a manifest inside the header of a pack) counts as part of the document.

use serde_json::{Map, Value, json};

use super::random::Random;
use super::text;

/// The document with one place changed.
pub fn mutated(document: &Value, random: &mut Random) -> Value {
    let mut changed = document.clone();
    let places = count(&changed);
    // The chosen place is the n-th in the order of a walk.
    let mut left = random.below(places);
    let donor = nth(document, random.below(places)).cloned().unwrap_or_default();
    change(&mut changed, &mut left, &donor, random);
    changed
}

/// How many values a document has, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(fields) => fields.values().map(count).sum(),
        Value::String(inner) => inside(inner).map_or(0, |inner| count(&inner)),
        _ => 0,
    }
}

/// A document inside a text.
fn inside(text: &str) -> Option<Value> {
    text.starts_with('{').then(|| serde_json::from_str(text).ok()).flatten()
}

fn nth(value: &Value, mut left: usize) -> Option<&Value> {
    fn walk<'a>(value: &'a Value, left: &mut usize) -> Option<&'a Value> {
        if *left == 0 {
            return Some(value);
        }
        *left -= 1;
        match value {
            Value::Array(items) => items.iter().find_map(|item| walk(item, left)),
            Value::Object(fields) => fields.values().find_map(|field| walk(field, left)),
            _ => None,
        }
    }
    walk(value, &mut left)
}

/// Walks to the chosen place and changes it. True when it was reached.
fn change(value: &mut Value, left: &mut usize, donor: &Value, random: &mut Random) -> bool {
    if *left == 0 {
        *value = replaced(value, donor, random);
        return true;
    }
    *left -= 1;
    match value {
        Value::Array(items) => items.iter_mut().any(|item| change(item, left, donor, random)),
        Value::Object(fields) => fields.values_mut().any(|field| change(field, left, donor, random)),
        Value::String(text) => {
            let Some(mut inner) = inside(text) else { return false };
            let reached = change(&mut inner, left, donor, random);
            *text = inner.to_string();
            reached
        }
        _ => false,
    }
}

fn replaced(value: &Value, donor: &Value, random: &mut Random) -> Value {
    if random.below(4) == 0 {
        let others = [donor.clone(), Value::Null, json!([]), json!({}), json!("x"), json!(0)];
        return others[random.below(others.len())].clone();
    }
    match value {
        Value::Number(number) => other_number(number.as_f64().unwrap_or(0.0), random),
        Value::String(text) => Value::from(text::hostile_string(text, random)),
        Value::Array(items) => Value::from(other_list(items.clone(), random)),
        Value::Object(fields) => Value::from(other_fields(fields.clone(), random)),
        Value::Bool(flag) => Value::from(!flag),
        Value::Null => donor.clone(),
    }
}

fn other_number(number: f64, random: &mut Random) -> Value {
    let huge = [json!(u64::MAX), json!(i64::MIN), json!(1e39), json!(1e308), json!(4_294_967_296_u64)];
    let near = [
        json!(number + 1.0),
        json!(-number),
        json!((number as i64).saturating_add(1)),
        json!((number as i64).saturating_sub(1)),
    ];
    let plain = [json!(0), json!(-1), json!(0.5), json!(100_000), json!(1_000_000_000), json!(65_536)];
    let kind = [&huge[..], &near, &plain][random.below(3)];
    kind[random.below(kind.len())].clone()
}

fn other_list(mut items: Vec<Value>, random: &mut Random) -> Vec<Value> {
    if items.is_empty() {
        return vec![json!(0); random.one_of(&[1, 3, 1000])];
    }
    let (one, two) = (random.below(items.len()), random.below(items.len()));
    match random.below(5) {
        0 => drop(items.remove(one)),
        1 => items.swap(one, two),
        2 => items.push(items[one].clone()),
        // Many, but a file of some megabytes at most.
        3 => {
            let times = (2 << 20) / (items[one].to_string().len() + 1);
            items.extend(vec![items[one].clone(); times.min(50_000)]);
        }
        _ => items.clear(),
    }
    items
}

fn other_fields(mut fields: Map<String, Value>, random: &mut Random) -> Map<String, Value> {
    let names: Vec<String> = fields.keys().cloned().collect();
    if names.is_empty() {
        fields.insert("x".to_owned(), json!(1));
        return fields;
    }
    let (one, two) = (&names[random.below(names.len())], &names[random.below(names.len())]);
    match random.below(4) {
        0 => drop(fields.remove(one)),
        1 => {
            let (first, second) = (fields[one].clone(), fields[two].clone());
            fields.insert(one.clone(), second);
            fields.insert(two.clone(), first);
        }
        2 => {
            let value = fields.remove(one).unwrap_or_default();
            fields.insert(text::hostile_string(one, random), value);
        }
        _ => {
            let value = fields[one].clone();
            let copies = ((2 << 20) / (value.to_string().len() + 16)).min(30_000);
            fields.extend((0..copies).map(|copy| (format!("{one}{copy}"), value.clone())));
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_reached_also_inside_a_text() {
        let document = json!({ "meta": "{\"version\":1}", "list": [1, 2] });
        assert_eq!(count(&document), 7);
        let mut reached = [false; 2];
        for seed in 0..400 {
            let changed = mutated(&document, &mut Random::new(seed));
            reached[0] |= changed["list"] != document["list"];
            reached[1] |= changed["meta"].as_str().is_some_and(|meta| meta.starts_with("{\"version\":2"));
        }
        assert_eq!(reached, [true; 2]);
    }

    #[test]
    fn a_list_is_enlarged_within_bounds() {
        let document = json!({ "list": [vec![0.5; 100]] });
        for seed in 0..60 {
            let length = mutated(&document, &mut Random::new(seed)).to_string().len();
            assert!(length < 8 << 20, "{length} bytes");
        }
    }
}
