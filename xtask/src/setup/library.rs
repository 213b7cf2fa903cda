//! Puts a native library into `third_party/NAME/{lib,include}` and says whether it is there already.
//!
//! The folder appears whole or not at all: everything is extracted next to it and moved into place at the end,
//! with a stamp inside that names what it holds. Ready means that the stamp is the pin's, the library hashes to
//! what it is pinned to and every link name leads to it; anything less is made anew.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use serde_json::{Value, json};
use zip::ZipArchive;

use super::download::{check_sha256, fetch_wheel, remove_folder};
use super::pins::{Build, NativeLibrary};

const STAMP: &str = "stamp.json";

/// A pinned library for this machine, and where it is to lie.
#[derive(Debug)]
pub struct Installation<'a> {
    library: &'a NativeLibrary,
    build: &'static Build,
    third_party: PathBuf,
}

impl<'a> Installation<'a> {
    /// The library for this machine's platform below the folder `third_party`.
    ///
    /// # Errors
    /// When there is no build for this platform.
    pub fn new(library: &'a NativeLibrary, third_party: PathBuf) -> Result<Self> {
        let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
        let build = library.build(os, arch).ok_or_else(|| {
            anyhow!(
                "{} {} has no build for {os} {arch} in the package index",
                library.package,
                library.version
            )
        })?;
        Ok(Self { library, build, third_party })
    }

    /// The library file, there or not.
    pub fn library_file(&self) -> PathBuf {
        self.folder().join("lib").join(self.build.library_name())
    }

    /// Makes sure that the library is there, fetching it if it is not. Costs one hash when it is.
    ///
    /// # Errors
    /// When it cannot be fetched, is not the pinned one, or cannot be written.
    pub fn ensure(&self) -> Result<()> {
        fs::create_dir_all(&self.third_party)
            .with_context(|| format!("create {}", self.third_party.display()))?;
        let lock_path = self.third_party.join("lock");
        let lock = File::create(&lock_path).with_context(|| format!("create {}", lock_path.display()))?;
        lock.lock().with_context(|| format!("lock {}", lock_path.display()))?;
        if self.is_ready() {
            return Ok(());
        }
        if self.holds_the_library(&self.folder()) {
            return self.write_stamp(&self.folder());
        }
        let downloads = self.third_party.join("downloads");
        let wheel = fetch_wheel(self.library, self.build, &downloads)?;
        self.install_from(&wheel)?;
        eprintln!(
            "xtask: {} {} is in {}",
            self.library.package,
            self.library.version,
            self.folder().display()
        );
        Ok(())
    }

    fn folder(&self) -> PathBuf {
        self.third_party.join(self.library.package)
    }

    fn stamp(&self) -> Value {
        json!({
            "version": self.library.version,
            "platform": format!("{} {}", self.build.os, self.build.arch),
            "wheel_sha256": self.build.wheel_sha256,
            "library_sha256": self.build.library_sha256,
        })
    }

    fn write_stamp(&self, folder: &Path) -> Result<()> {
        let path = folder.join(STAMP);
        fs::write(&path, format!("{:#}\n", self.stamp())).with_context(|| format!("write {}", path.display()))
    }

    /// Whether the folder is complete and holds the pinned library.
    fn is_ready(&self) -> bool {
        let stamp = fs::read_to_string(self.folder().join(STAMP)).ok();
        let stamp: Option<Value> = stamp.and_then(|text| serde_json::from_str(&text).ok());
        stamp == Some(self.stamp()) && self.holds_the_library(&self.folder())
    }

    /// Whether a folder, stamped or not, holds the pinned library under all its names.
    fn holds_the_library(&self, folder: &Path) -> bool {
        let lib = folder.join("lib");
        let import_library = !cfg!(windows) || lib.join(import_library_name(self.build)).is_file();
        import_library
            && self.build.links.iter().all(|link| lib.join(link).is_file())
            && (self.library.headers.is_none() || folder.join("include").is_dir())
            && check_sha256(&lib.join(self.build.library_name()), self.build.library_sha256).is_ok()
    }

    /// Extracts a wheel beside the final folder and moves it into place.
    fn install_from(&self, wheel: &Path) -> Result<()> {
        let scratch = self.third_party.join(format!("{}.partial", self.library.package));
        remove_folder(&scratch)?;
        self.extract(wheel, &scratch)?;
        ensure!(
            self.holds_the_library(&scratch),
            "{} did not hold {} with sha256 {}",
            wheel.display(),
            self.build.library,
            self.build.library_sha256
        );
        self.write_stamp(&scratch)?;
        remove_folder(&self.folder())?;
        fs::rename(&scratch, self.folder()).with_context(|| format!("move into {}", self.folder().display()))
    }

    fn extract(&self, wheel: &Path, into: &Path) -> Result<()> {
        let file = File::open(wheel).with_context(|| format!("open {}", wheel.display()))?;
        let mut archive = ZipArchive::new(file).with_context(|| format!("read {}", wheel.display()))?;
        for index in 0..archive.len() {
            let mut entry = archive.by_index(index).with_context(|| format!("read {}", wheel.display()))?;
            if entry.is_dir() {
                continue;
            }
            let name = entry.name().with_context(|| format!("read {}", wheel.display()))?.into_owned();
            let path = match self.library.headers.and_then(|folder| name.strip_prefix(folder)) {
                Some(header) => into.join("include").join(safe(header)?),
                None if name == self.build.library => into.join("lib").join(self.build.library_name()),
                None => continue,
            };
            create_parent(&path)?;
            let mut out = File::create(&path).with_context(|| format!("create {}", path.display()))?;
            io::copy(&mut entry, &mut out)
                .with_context(|| format!("extract {name} from {}", wheel.display()))?;
        }
        let lib = into.join("lib");
        for link in self.build.links {
            make_link(&lib, link, self.build.library_name())?;
        }
        #[cfg(windows)]
        super::import_library::write(
            &lib.join(self.build.library_name()),
            &lib.join(import_library_name(self.build)),
        )?;
        Ok(())
    }
}

/// `mujoco.dll` is linked through `mujoco.lib`.
fn import_library_name(build: &Build) -> String {
    build.library_name().replace(".dll", ".lib")
}

/// A path from an archive, refused when it would leave the folder it is extracted to.
fn safe(name: &str) -> Result<&Path> {
    let path = Path::new(name);
    let inside = path.components().all(|part| matches!(part, std::path::Component::Normal(_)));
    ensure!(inside, "the archive has an entry that leaves its folder: {name}");
    Ok(path)
}

fn create_parent(path: &Path) -> Result<()> {
    let parent = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(parent).with_context(|| format!("create {}", parent.display()))
}

/// Makes `link`, relative to the folder `lib`, lead to the file `target` in `lib`.
fn make_link(lib: &Path, link: &str, target: &str) -> Result<()> {
    let path = lib.join(link);
    create_parent(&path)?;
    #[cfg(unix)]
    let made =
        std::os::unix::fs::symlink(format!("{}{target}", "../".repeat(link.matches('/').count())), &path);
    #[cfg(not(unix))]
    let made = fs::copy(lib.join(target), &path).map(drop);
    made.with_context(|| format!("make {} lead to {target}", path.display()))
}

#[cfg(test)]
#[path = "library_tests.rs"]
mod tests;
