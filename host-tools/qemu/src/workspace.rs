//! Where the sources are, and where images go.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::{env, io};

use crate::Error;

/// A checkout of tempco.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Workspace {
    root: PathBuf,
}

impl Workspace {
    /// Finds the checkout: upwards from the current folder, else where this program was compiled.
    ///
    /// # Errors
    /// There is none in either place.
    pub fn find() -> Result<Self, Error> {
        let start = env::current_dir().map_err(Error::file(Path::new(".")))?;
        let built_in = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        Self::search(&start, &built_in)
    }

    fn search(start: &Path, built_in: &Path) -> Result<Self, Error> {
        start
            .ancestors()
            .chain([built_in])
            .find(|folder| is_workspace(folder))
            .and_then(|folder| folder.canonicalize().ok())
            .map(|root| Self { root })
            .ok_or_else(|| Error::NoWorkspace {
                start: start.to_owned(),
                built_in: built_in.to_owned(),
            })
    }

    /// The folder of the root manifest.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where firmware is built, apart from cargo's other artefacts: a build of them need not end first.
    pub fn target_dir(&self) -> PathBuf {
        self.host_dir().join("firmware")
    }

    /// Where cargo builds for this machine.
    pub(crate) fn host_dir(&self) -> PathBuf {
        let target = env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
        self.root.join(target)
    }

    /// Waits until no other process or thread builds or installs; lasts until dropped.
    pub(crate) fn lock(&self) -> Result<Lock, Error> {
        let folder = self.target_dir();
        let path = folder.join("tempco-qemu.lock");
        let locked = || -> io::Result<File> {
            fs::create_dir_all(&folder)?;
            let file = File::create(&path)?;
            file.lock()?;
            Ok(file)
        };
        locked().map(Lock).map_err(Error::file(&path))
    }
}

/// Unlocks when dropped.
#[derive(Debug)]
pub(crate) struct Lock(#[expect(dead_code, reason = "held for its drop")] File);

/// Whether `folder` is the root of tempco rather than of any other workspace.
fn is_workspace(folder: &Path) -> bool {
    folder.join("Cargo.toml").is_file()
        && fs::read_to_string(folder.join("firmware/Cargo.toml"))
            .is_ok_and(|manifest| manifest.contains("name = \"tempco-firmware\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_checkout_from_within_and_from_elsewhere() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../..")
            .canonicalize()
            .unwrap();
        assert_eq!(Workspace::find().unwrap().root(), root);

        let elsewhere = tempfile::tempdir().unwrap();
        let found = |start: &Path, built_in: &Path| Workspace::search(start, built_in);
        assert_eq!(
            found(&root.join("firmware/src"), elsewhere.path())
                .unwrap()
                .root(),
            root
        );
        assert_eq!(found(elsewhere.path(), &root).unwrap().root(), root);
    }

    #[test]
    fn does_not_take_another_workspace_for_this_one() {
        let other = tempfile::tempdir().unwrap();
        fs::create_dir(other.path().join("firmware")).unwrap();
        for manifest in ["Cargo.toml", "firmware/Cargo.toml"] {
            fs::write(
                other.path().join(manifest),
                "[package]\nname = \"somebody-elses\"\n",
            )
            .unwrap();
        }
        let error = Workspace::search(other.path(), other.path()).unwrap_err();
        assert!(error.to_string().contains("start this in a checkout"));
    }
}
