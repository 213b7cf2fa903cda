//! Makes the import library that a Windows linker wants, from the names that a DLL exports.
//!
//! The wheel of Windows carries `mujoco.dll` without `mujoco.lib`. Not tried on a Windows machine yet.

use std::fs::{self, File};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use implib::{Flavor, ImportLibrary, MachineType};
use object::read::pe::PeFile64;

/// Reads the exports of `dll` and writes the import library `lib`.
///
/// # Errors
/// When the DLL cannot be read, is not a 64-bit one or exports nothing, or the library cannot be written.
pub fn write(dll: &Path, lib: &Path) -> Result<()> {
    let data = fs::read(dll).with_context(|| format!("read {}", dll.display()))?;
    let name = dll.file_name().unwrap_or_default().to_string_lossy();
    let definition = definition(&name, &exports(&data).with_context(|| format!("parse {}", dll.display()))?);
    let library = ImportLibrary::new(&definition, MachineType::AMD64, Flavor::Msvc)
        .with_context(|| format!("make {}", lib.display()))?;
    let mut file = File::create(lib).with_context(|| format!("create {}", lib.display()))?;
    library.write_to(&mut file).with_context(|| format!("write {}", lib.display()))
}

fn exports(data: &[u8]) -> Result<Vec<String>> {
    let file = PeFile64::parse(data)?;
    let table = file.export_table()?.context("it exports nothing")?;
    let mut names = Vec::new();
    for export in table.exports()? {
        if let Some(name) = export.name {
            names.push(String::from_utf8_lossy(name).into_owned());
        }
    }
    ensure!(!names.is_empty(), "it exports nothing by name");
    Ok(names)
}

/// A module definition: the DLL's name and one exported name a line.
fn definition(dll: &str, names: &[String]) -> String {
    let mut text = format!("LIBRARY {dll}\nEXPORTS\n");
    for name in names {
        text.push_str(&format!("    {name}\n"));
    }
    text
}
