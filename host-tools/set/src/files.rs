//! Writes files that belong together: all of them or none, and nothing unfinished stays.
//!
//! A [`Draft`] is written in full beside its place. [`keep_all`] then moves drafts to their places,
//! one after the other; if a move fails, those before it are undone. What no program can undo is
//! its own sudden end between two moves: the last file of a group is therefore its mark, by which a
//! reader sees whether the others are of the same group (see
//! [`strangers`](crate::strangers)).
//!
//! A program that is told to end calls [`abandon`], which waits for moves under way and removes all
//! drafts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{TempDir, TempPath};

/// What is to be removed if the program ends now.
struct Unfinished {
    files: BTreeMap<PathBuf, TempPath>,
    /// Made for a draft; they go if they are empty.
    folders: BTreeSet<PathBuf>,
    scratch: BTreeMap<PathBuf, TempDir>,
}

static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished {
    files: BTreeMap::new(),
    folders: BTreeSet::new(),
    scratch: BTreeMap::new(),
});

fn unfinished() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all drafts and scratch folders, for a program that ends at once: a thread that writes a
/// file after this waits for ever.
pub fn abandon() {
    let mut unfinished = unfinished();
    unfinished.files.clear();
    unfinished.scratch.clear();
    for folder in unfinished.folders.iter().rev() {
        let _ = fs::remove_dir(folder);
    }
    std::mem::forget(unfinished);
}

/// A file that is not whole yet; it is removed unless it is kept.
#[derive(Debug)]
pub struct Draft {
    // Closed before it is removed, as some systems demand: the fields are dropped in this order.
    file: File,
    place: Place,
}

/// Where a draft is and where it is to be.
#[derive(Debug)]
struct Place {
    temp: PathBuf,
    path: PathBuf,
}

impl Draft {
    /// An empty draft of `path`, whose folder is made if need be.
    ///
    /// # Errors
    /// What the system says, with the path; a place that a file cannot take.
    pub fn create(path: &Path) -> io::Result<Self> {
        let context = |error| at(path, error);
        if path.file_name().is_none() {
            return Err(context(io::Error::other("expected the name of a file")));
        }
        let folder = folder_of(path);
        let mut unfinished = unfinished();
        if !folder.exists() {
            fs::create_dir_all(folder).map_err(context)?;
            unfinished.folders.insert(folder.to_owned());
        }
        let created = new_file_in(folder).inspect_err(|_| unfinished.remove_if_new(folder));
        let (file, temp) = created.map_err(context)?.into_parts();
        let place = Place {
            temp: temp.to_path_buf(),
            path: path.to_owned(),
        };
        unfinished.files.insert(place.temp.clone(), temp);
        Ok(Self { file, place })
    }

    /// Where to write.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        // Nothing, if it was kept.
        if unfinished.files.remove(&self.temp).is_some() {
            unfinished.remove_if_new(folder_of(&self.path));
        }
    }
}

impl Unfinished {
    /// Removes a folder that was made in vain, unless there is something in it.
    fn remove_if_new(&mut self, folder: &Path) {
        if self.folders.contains(folder) && fs::remove_dir(folder).is_ok() {
            self.folders.remove(folder);
        }
    }
}

/// A step that leads from the files that are there to those that are to be there.
enum Step {
    Move(Draft),
    Remove(PathBuf),
}

/// Moves drafts to their places, in their order: all of them or, on any failure, none.
///
/// # Errors
/// What the system says, with the path.
pub fn keep_all(drafts: Vec<Draft>) -> io::Result<()> {
    carry_out(drafts.into_iter().map(Step::Move).collect(), || ())
}

/// Writes `files` into `folder`, which is made if need be: all of them or, on any failure, none.
///
/// # Errors
/// What the system says, with the path.
pub fn write_files(folder: &Path, files: &[(&str, &[u8])]) -> io::Result<()> {
    replace_with(folder, files, &[], || ())
}

/// Writes `files` and removes those called `obsolete`, all of it or nothing, with a call before
/// each step; the last file is the mark of the group.
pub(crate) fn replace_with(
    folder: &Path,
    files: &[(&str, &[u8])],
    obsolete: &[&str],
    before_each: impl FnMut(),
) -> io::Result<()> {
    let mut steps = Vec::new();
    for (name, contents) in files {
        let mut draft = Draft::create(&folder.join(name))?;
        draft
            .file
            .write_all(contents)
            .map_err(|error| at(&draft.place.path, error))?;
        steps.push(Step::Move(draft));
    }
    let mark = steps.len().saturating_sub(1);
    let gone = obsolete.iter().map(|name| Step::Remove(folder.join(name)));
    steps.splice(mark..mark, gone);
    carry_out(steps, before_each)
}

/// Carries out steps, with a call before each; on a failure, undoes those before it.
fn carry_out(steps: Vec<Step>, mut before_each: impl FnMut()) -> io::Result<()> {
    for step in &steps {
        if let Step::Move(draft) = step {
            let synced = draft.file.sync_all();
            synced.map_err(|error| at(&draft.place.path, error))?;
        }
    }
    // Held throughout: whoever tells the program to end waits for the last step.
    let mut unfinished = unfinished();
    let formers: Vec<Option<TempPath>> = steps
        .iter()
        .map(|step| keep_former(step.path()))
        .collect::<Result<_, _>>()?;
    let mut done: Vec<(&Path, Option<TempPath>)> = Vec::new();
    for (number, (step, former)) in steps.iter().zip(formers).enumerate() {
        if number + 1 == steps.len() {
            // The mark of the group must not be on the disk before the rest is.
            sync_folders(&done);
        }
        before_each();
        let path = step.path();
        match step.carry_out(&mut unfinished) {
            Ok(()) => done.push((path, former)),
            Err(error) => {
                let mut error = at(path, error);
                for (path, former) in done.into_iter().rev() {
                    if let Err(further) = put_back(path, former) {
                        error = at(path, further);
                    }
                }
                return Err(error);
            }
        }
    }
    sync_folders(&done);
    for (path, _) in &done {
        unfinished.folders.remove(folder_of(path));
    }
    // The second names of the former files go while the lock is held.
    drop(done);
    Ok(())
}

impl Step {
    fn path(&self) -> &Path {
        match self {
            Self::Move(draft) => &draft.place.path,
            Self::Remove(path) => path,
        }
    }

    fn carry_out(&self, unfinished: &mut Unfinished) -> io::Result<()> {
        match self {
            Self::Move(draft) => match unfinished.files.remove(&draft.place.temp) {
                Some(temp) => temp.persist(&draft.place.path).map_err(|error| error.error),
                None => Err(io::ErrorKind::NotFound.into()),
            },
            Self::Remove(path) => remove_if_there(path),
        }
    }
}

/// A second name for a file, by which its present contents can be put back; none where there is
/// no file.
fn keep_former(path: &Path) -> io::Result<Option<TempPath>> {
    match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(at(path, error)),
        // Moving a file to the name of a device or pipe would put the file in its place.
        Ok(former) if !former.is_file() => Err(io::Error::other(format!(
            "{} is there and is not a regular file",
            path.display()
        ))),
        Ok(_) => {
            let kept = tempfile::Builder::new().make_in(folder_of(path), |name| {
                fs::hard_link(path, name).or_else(|error| match error.kind() {
                    io::ErrorKind::AlreadyExists => Err(error),
                    // Not every file system has links.
                    _ => fs::copy(path, name).map(drop),
                })
            });
            let kept = kept.map_err(|error| at(path, error))?;
            Ok(Some(kept.into_temp_path()))
        }
    }
}

fn put_back(path: &Path, former: Option<TempPath>) -> io::Result<()> {
    match former {
        Some(former) => former.persist(path).map_err(|error| error.error),
        None => remove_if_there(path),
    }
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Has the names in the folders of files written to the disk, on systems that can be asked for it.
fn sync_folders(files: &[(&Path, Option<TempPath>)]) {
    let folders: BTreeSet<&Path> = files.iter().map(|(path, _)| folder_of(path)).collect();
    for folder in folders {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn at(path: &Path, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// A temporary file that others may read once it has its name, as far as the user's mask allows.
fn new_file_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    #[cfg(unix)]
    {
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o666);
        let mut builder = tempfile::Builder::new();
        builder.permissions(mode).tempfile_in(folder)
    }
    #[cfg(not(unix))]
    tempfile::NamedTempFile::new_in(folder)
}

/// A folder for files in passing, which no other user can reach; removed at the end.
#[derive(Debug)]
pub struct ScratchFolder {
    path: PathBuf,
}

impl ScratchFolder {
    /// An empty folder among the temporary files of the system.
    ///
    /// # Errors
    /// What the system says.
    pub fn new() -> io::Result<Self> {
        let mut unfinished = unfinished();
        let folder = TempDir::with_prefix("tempco-")?;
        let path = folder.path().to_owned();
        unfinished.scratch.insert(path.clone(), folder);
        Ok(Self { path })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        unfinished().scratch.remove(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    #[test]
    fn all_files_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("new/set");
        write_files(&out, &[("a", b"1"), ("b", b"2")]).unwrap();
        assert_eq!(fs::read(out.join("b")).unwrap(), b"2");

        // A folder where a file should go is seen before anything is moved.
        fs::create_dir(out.join("c")).unwrap();
        assert!(write_files(&out, &[("a", b"3"), ("c", b"4")]).is_err());
        assert_eq!(fs::read(out.join("a")).unwrap(), b"1");
        assert_eq!(names(&out), ["a", "b", "c"]);
    }

    /// The second move fails since its draft was taken away.
    #[test]
    fn what_was_done_before_a_failure_is_undone() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        write_files(root, &[("a", b"1"), ("old", b"2")]).unwrap();
        for name in ["a", "new"] {
            let mut calls = 0;
            let obsolete = ["never", "old"];
            let result = replace_with(root, &[(name, b"3"), ("b", b"4")], &obsolete, || {
                calls += 1;
                if calls == 4 {
                    assert!(!root.join("old").exists());
                    assert_eq!(fs::read(root.join(name)).unwrap(), b"3");
                    for draft in names(root).iter().filter(|n| n.starts_with(".tmp")) {
                        if fs::read(root.join(draft)).unwrap() == b"4" {
                            fs::remove_file(root.join(draft)).unwrap();
                        }
                    }
                }
            });
            assert!(result.unwrap_err().to_string().contains("/b: "));
            assert_eq!(names(root), ["a", "old"], "{name}");
            assert_eq!(fs::read(root.join("a")).unwrap(), b"1");
            assert_eq!(fs::read(root.join("old")).unwrap(), b"2");
        }
        replace_with(root, &[("a", b"3")], &["old", "never"], || ()).unwrap();
        assert_eq!(names(root), ["a"]);
    }

    /// A socket stands for devices and pipes, which take more to make.
    #[cfg(unix)]
    #[test]
    fn what_is_not_a_regular_file_is_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("special");
        let _socket = std::os::unix::net::UnixListener::bind(&path).unwrap();
        let error = write_files(folder.path(), &[("special", b"1")]).unwrap_err();
        assert!(error.to_string().contains("not a regular file"), "{error}");
        assert!(fs::metadata(&path).unwrap().file_type().is_socket());
        assert_eq!(names(folder.path()), ["special"]);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), b"").unwrap();
        let error = write_files(&folder.path().join("file/set"), &[("a", b"1")]).unwrap_err();
        assert!(error.to_string().contains("file/set"), "{error}");
    }

    #[test]
    fn a_draft_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/file");
        let mut draft = Draft::create(&path).unwrap();
        draft.file().write_all(b"1").unwrap();
        assert_eq!(names(&folder.path().join("new")).len(), 1);
        drop(draft);
        assert!(names(folder.path()).is_empty());

        let draft = Draft::create(&path).unwrap();
        keep_all(vec![draft]).unwrap();
        assert_eq!(names(&folder.path().join("new")), ["file"]);
    }
}
