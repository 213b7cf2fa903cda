//! The lock of a run's folder: one trainer writes there at a time, and the file says which one.
//!
//! The operating system holds the lock and drops it when the process ends, however it ends. The text in the file only
//! names the holder, so a stale text never keeps anyone out.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::RunError;

/// Name of the lock's file.
pub const LOCK_FILE: &str = "run.lock";

/// Longest text of a holder, bytes.
const MOST_BYTES: u64 = 4096;

/// Who holds a run's folder, or held it when it crashed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// Its process.
    pub pid: u32,
    /// Its machine.
    pub host: String,
    /// When it took the lock, seconds since 1970 (UTC).
    pub since: u64,
}

impl Holder {
    /// This process, now.
    fn this_process() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        let host = gethostname::gethostname().to_string_lossy().into_owned();
        Self { pid: std::process::id(), host, since }
    }
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (days, secs) = (self.since / 86_400, self.since % 86_400);
        let (year, month, day) = civil(days);
        let (hour, minute, second) = (secs / 3600, secs / 60 % 60, secs % 60);
        write!(
            f,
            "process {} on {} since {year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC",
            self.pid, self.host
        )
    }
}

/// Year, month and day of a count of days since 1970 (Hinnant, "chrono-compatible low-level date algorithms").
fn civil(days: u64) -> (u64, u64, u64) {
    let z = days + 719_468;
    let (era, day_of_era) = (z / 146_097, z % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    (year_of_era + era * 400 + u64::from(month <= 2), month, day)
}

/// The held lock. Dropping it empties the file and lets the next trainer in.
#[derive(Debug)]
pub struct RunLock {
    file: File,
    /// The trainer that held the folder and ended without letting go of it, if one did.
    pub crashed: Option<Holder>,
}

impl RunLock {
    /// Takes the lock of a folder, without waiting.
    ///
    /// # Errors
    /// [`RunError::Locked`] when another process holds it; [`RunError::Io`] when the file can't be used.
    pub fn take(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK_FILE);
        let io = |source| RunError::Io { path: path.clone(), source };
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(io)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(RunError::Locked { folder: folder.to_owned(), holder: read(&mut file) });
            }
            Err(TryLockError::Error(source)) => return Err(io(source)),
        }
        let crashed = read(&mut file);
        write(&mut file, &Holder::this_process()).map_err(io)?;
        Ok(Self { file, crashed })
    }

    /// Path of a folder's lock.
    #[must_use]
    pub fn path(folder: &Path) -> PathBuf {
        folder.join(LOCK_FILE)
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        // A text that stays is taken for a crash's; the system releases the lock in any case.
        let _ = self.file.set_len(0);
    }
}

/// The holder that the file names, if it names one.
fn read(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.seek(SeekFrom::Start(0)).ok()?;
    file.take(MOST_BYTES).read_to_string(&mut text).ok()?;
    toml::from_str(&text).ok()
}

fn write(file: &mut File, holder: &Holder) -> std::io::Result<()> {
    let text = toml::to_string(holder).map_err(std::io::Error::other)?;
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_trainer_is_told_who_holds_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let held = RunLock::take(folder.path()).unwrap();
        let error = RunLock::take(folder.path()).unwrap_err();
        let RunError::Locked { holder: Some(holder), .. } = &error else { panic!("{error}") };
        assert_eq!(holder.pid, std::process::id());
        assert!(error.to_string().contains(&format!("process {}", holder.pid)), "{error}");
        drop(held);
        assert_eq!(RunLock::take(folder.path()).unwrap().crashed, None);
    }

    #[test]
    fn a_lock_that_a_crash_left_keeps_nobody_out_and_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let past = Holder { pid: 1, host: "elsewhere".into(), since: 1_700_000_000 };
        std::fs::write(RunLock::path(folder.path()), toml::to_string(&past).unwrap()).unwrap();
        assert_eq!(RunLock::take(folder.path()).unwrap().crashed, Some(past));
        std::fs::write(RunLock::path(folder.path()), "no text of ours").unwrap();
        assert_eq!(RunLock::take(folder.path()).unwrap().crashed, None);
    }

    #[test]
    fn times_are_those_of_the_calendar() {
        let holder = |since| Holder { pid: 7, host: "a".into(), since }.to_string();
        assert_eq!(holder(0), "process 7 on a since 1970-01-01 00:00:00 UTC");
        assert_eq!(holder(1_709_210_096), "process 7 on a since 2024-02-29 12:34:56 UTC");
        assert_eq!(holder(1_798_761_599), "process 7 on a since 2026-12-31 23:59:59 UTC");
    }
}
