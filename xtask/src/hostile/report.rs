//! What the readers made of the files: counts for each reader, and every different fault once.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};

use super::child::{Fault, Outcome};

/// Counts of one reader.
#[derive(Debug, Default)]
struct Counts {
    cases: usize,
    accepted: usize,
    refused: usize,
    broken: usize,
    slowest: Duration,
}

/// One fault of one reader, however often it was met.
#[derive(Debug)]
pub struct Finding {
    count: usize,
    /// Name of the file that was kept.
    file: String,
}

/// Everything that was found.
#[derive(Debug, Default)]
pub struct Report {
    readers: BTreeMap<String, Counts>,
    findings: BTreeMap<(String, Fault, String), Finding>,
}

impl Report {
    /// Counts one file. The name to keep it under when its fault is new.
    pub fn add(&mut self, reader: &str, outcome: &Outcome, time: Duration, path: &Path) -> Option<String> {
        let counts = self.readers.entry(reader.to_owned()).or_default();
        counts.cases += 1;
        counts.slowest = counts.slowest.max(time);
        let (fault, what) = match outcome {
            Outcome::Accepted => {
                counts.accepted += 1;
                return None;
            }
            Outcome::Refused => {
                counts.refused += 1;
                return None;
            }
            Outcome::Broken(fault, what) => (*fault, what.clone()),
        };
        counts.broken += 1;
        let number = self.findings.len();
        let key = (reader.to_owned(), fault, what);
        if let Some(known) = self.findings.get_mut(&key) {
            known.count += 1;
            return None;
        }
        let folder = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        let kind = if folder.starts_with("worker-") { String::new() } else { format!("-{folder}") };
        let ending = path.file_name().unwrap_or_default().to_string_lossy();
        let file = format!("{reader}-{}-{number}{kind}-{ending}", fault.name());
        self.findings.insert(key, Finding { count: 1, file: file.clone() });
        Some(file)
    }

    /// Every different fault.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.findings.values()
    }

    /// One JSON object.
    pub fn to_json(&self, seconds: f64) -> Value {
        let readers: serde_json::Map<String, Value> = self
            .readers
            .iter()
            .map(|(name, counts)| {
                let figures = json!({
                    "cases": counts.cases,
                    "accepted": counts.accepted,
                    "refused": counts.refused,
                    "broken": counts.broken,
                    "slowest_ms": counts.slowest.as_millis() as u64,
                });
                (name.clone(), figures)
            })
            .collect();
        let findings: Vec<Value> = self
            .findings
            .iter()
            .map(|((reader, fault, what), finding)| {
                json!({
                    "reader": reader,
                    "fault": fault.name(),
                    "what": what,
                    "count": finding.count,
                    "file": finding.file,
                })
            })
            .collect();
        let cases: usize = self.readers.values().map(|counts| counts.cases).sum();
        json!({ "cases": cases, "seconds": seconds, "readers": readers, "findings": findings })
    }

    /// A table for people.
    pub fn to_table(&self, seconds: f64) -> String {
        let mut text = format!(
            "{:16} {:>7} {:>9} {:>8} {:>7} {:>12}\n",
            "reader", "cases", "accepted", "refused", "broken", "slowest, ms"
        );
        for (name, counts) in &self.readers {
            text.push_str(&format!(
                "{name:16} {:7} {:9} {:8} {:7} {:12}\n",
                counts.cases,
                counts.accepted,
                counts.refused,
                counts.broken,
                counts.slowest.as_millis()
            ));
        }
        let cases: usize = self.readers.values().map(|counts| counts.cases).sum();
        text.push_str(&format!("{cases} files in {seconds:.0} s\n"));
        for ((reader, fault, what), finding) in &self.findings {
            text.push_str(&format!(
                "{reader} {} {}x: {what}\n    cargo xtask hostile --reader {reader} --file out/hostile/{}\n",
                fault.name(),
                finding.count,
                finding.file
            ));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_listed_once_with_its_count() {
        let mut report = Report::default();
        let path = Path::new("target/hostile/worker-0/walk.ron");
        let broken = Outcome::Broken(Fault::Panic, "src/a.rs:1:2: no".to_owned());
        let kept = report.add("script", &broken, Duration::from_millis(3), path);
        assert_eq!(kept.as_deref(), Some("script-panic-0-walk.ron"));
        assert_eq!(report.add("script", &broken, Duration::ZERO, path), None);
        assert_eq!(report.add("script", &Outcome::Refused, Duration::from_millis(9), path), None);
        let json = report.to_json(1.5);
        assert_eq!(json["cases"], 3);
        assert_eq!(json["findings"][0]["count"], 2);
        assert_eq!(json["readers"]["script"]["slowest_ms"], 9);
        assert!(report.to_table(1.5).contains("script panic 2x: src/a.rs:1:2: no\n"));
    }

    #[test]
    fn a_special_file_is_named_after_its_kind() {
        let path = Path::new("target/hostile/worker-0/pipe/walk.ron");
        let hang = Outcome::Broken(Fault::Hang, "waits for ever".to_owned());
        let kept = Report::default().add("script", &hang, Duration::ZERO, path);
        assert_eq!(kept.as_deref(), Some("script-hang-0-pipe-walk.ron"));
    }
}
