//! Files on their way into a zip, whose bytes depend on names and contents alone.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use anyhow::{Context, Result};
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The file with the hashes of all others.
const SUMS: &str = "SHA256SUMS";

/// Files by their paths, with `/` between folders.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    files: BTreeMap<String, File>,
}

#[derive(Clone, Debug)]
struct File {
    bytes: Vec<u8>,
    is_program: bool,
}

impl Tree {
    /// Adds a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn add(&mut self, path: &str, from: &Path) -> Result<()> {
        let bytes = fs::read(from).with_context(|| from.display().to_string())?;
        let is_program = false;
        self.files
            .insert(path.to_owned(), File { bytes, is_program });
        Ok(())
    }

    /// Adds a program.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn add_program(&mut self, path: &str, from: &Path) -> Result<()> {
        self.add(path, from)?;
        if let Some(file) = self.files.get_mut(path) {
            file.is_program = true;
        }
        Ok(())
    }

    /// Adds all files of a folder and the folders in it.
    ///
    /// # Errors
    /// One cannot be read, or has a name that is not Unicode.
    pub fn add_folder(&mut self, prefix: &str, folder: &Path) -> Result<()> {
        for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            let name = path.file_name().and_then(|name| name.to_str());
            let name = format!("{prefix}{}", name.context("a name that is not Unicode")?);
            if path.is_dir() {
                self.add_folder(&format!("{name}/"), &path)?;
            } else {
                self.add(&name, &path)?;
            }
        }
        Ok(())
    }

    /// The zip, with everything in a folder `name`, and with a file of hashes for `sha256sum -c`.
    ///
    /// # Errors
    /// A file that is too large for a zip.
    pub fn zip(mut self, name: &str) -> Result<Vec<u8>> {
        let sums = self.files.iter().map(|(path, file)| {
            let hash = HEXLOWER.encode(&Sha256::digest(&file.bytes));
            format!("{hash}  {path}\n")
        });
        let bytes = sums.collect::<String>().into_bytes();
        let is_program = false;
        self.files
            .insert(SUMS.to_owned(), File { bytes, is_program });

        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (path, file) in self.files {
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                .last_modified_time(DateTime::default())
                .unix_permissions(if file.is_program { 0o755 } else { 0o644 });
            zip.start_file(format!("{name}/{path}"), options)?;
            zip.write_all(&file.bytes)?;
        }
        Ok(zip.finish()?.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, SystemTime};

    use super::*;

    fn zip_of(names: [&str; 2], time: SystemTime) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        for name in names {
            let path = folder.path().join(name);
            fs::write(&path, name).unwrap();
            fs::File::open(&path).unwrap().set_modified(time).unwrap();
        }
        let mut tree = Tree::default();
        tree.add_folder("", folder.path()).unwrap();
        tree.zip("x").unwrap()
    }

    /// Neither the times of the files nor the order in which they were made is in it.
    #[test]
    fn the_same_files_give_the_same_bytes() {
        let now = SystemTime::now();
        let first = zip_of(["a.txt", "b/c.txt"], now);
        let second = zip_of(["b/c.txt", "a.txt"], now - Duration::from_secs(1_000_000));
        assert!(first == second);
        assert!(first != zip_of(["a.txt", "b/d.txt"], now));
    }

    #[test]
    fn the_hashes_are_those_of_the_files() {
        let bytes = zip_of(["a.txt", "b/c.txt"], SystemTime::now());
        let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let count = zip.len();
        let name = |at: usize| zip.by_index(at).unwrap().name().unwrap().into_owned();
        let names: Vec<String> = (0..count).map(name).collect();
        assert_eq!(names, ["x/SHA256SUMS", "x/a.txt", "x/b/c.txt"]);
        let sums = std::io::read_to_string(zip.by_name("x/SHA256SUMS").unwrap()).unwrap();
        let hash = HEXLOWER.encode(&Sha256::digest(b"b/c.txt"));
        assert!(sums.contains(&format!("{hash}  b/c.txt\n")), "{sums}");
        assert_eq!(sums.lines().count(), 2);
    }
}
