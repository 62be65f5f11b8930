//! Puts a folder in its place whole or not at all, and never over anything but an earlier virtual campaign.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::digest::Digest;
use super::truth::Truth;
use super::{Error, io_error};

/// A folder being filled beside its place.
pub(super) struct NewFolder {
    place: PathBuf,
    filling: TempDir,
}

impl NewFolder {
    /// Begins a folder that is to stand at `place`.
    ///
    /// # Errors
    /// If something else than an empty folder or an earlier virtual campaign is there, if that was edited and `force` does not
    /// say that it goes all the same, or if nothing can be written.
    pub(super) fn begin(place: &Path, force: bool) -> Result<Self, Error> {
        let place = check(place, force)?;
        let parent = place.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::create_dir_all(parent).map_err(|source| io_error(parent, "create the folder", source))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".virtual-tank-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // As any new folder: what the user's umask leaves.
            builder.permissions(fs::Permissions::from_mode(0o777));
        }
        let filling = builder.tempdir_in(parent).map_err(|source| io_error(parent, "write into", source))?;
        Ok(Self { place, filling })
    }

    /// Where to write.
    pub(super) fn path(&self) -> &Path {
        self.filling.path()
    }

    /// Moves the filled folder to its place; an earlier campaign there goes only once the new one stands.
    pub(super) fn finish(self) -> Result<(), Error> {
        let Self { place, filling } = self;
        let fail = |source: io::Error| io_error(&place, "move the finished campaign to", source);
        let beside = place.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let earlier = tempfile::Builder::new().prefix(".virtual-tank-old-").tempdir_in(beside).map_err(fail)?;
        let earlier_place = earlier.path().join("campaign");
        let was_there = place.exists();
        if was_there {
            fs::rename(&place, &earlier_place).map_err(fail)?;
        }
        let filled = filling.keep();
        if let Err(source) = fs::rename(&filled, &place) {
            if was_there {
                // Back as it was; if even that fails, the first error is the one to tell.
                let _ = fs::rename(&earlier_place, &place);
            }
            let _ = fs::remove_dir_all(&filled);
            return Err(fail(source));
        }
        Ok(())
    }
}

/// The place, if a campaign may be written there.
fn check(place: &Path, force: bool) -> Result<PathBuf, Error> {
    let Ok(place) = place.canonicalize() else {
        return Ok(place.to_owned());
    };
    if !place.is_dir() {
        return Err(Error::FolderInUse { path: place, found: "it is a file".to_owned() });
    }
    if std::env::current_dir().is_ok_and(|here| here.canonicalize().is_ok_and(|here| here.starts_with(&place))) {
        return Err(Error::FolderInUse { path: place, found: "this command runs in it".to_owned() });
    }
    let names = names(&place).map_err(|source| io_error(&place, "read the folder", source))?;
    if names.is_empty() {
        return Ok(place);
    }
    let Some(truth) = Truth::read(&place) else {
        let found = format!("it holds {} and is no virtual campaign", names[0]);
        return Err(Error::FolderInUse { path: place, found });
    };
    let ours = |name: &String| ["campaign.toml", "runs.csv", "truth.toml", "data"].contains(&name.as_str());
    let mut foreign = names.into_iter().find(|name| !ours(name));
    if foreign.is_none() && place.join("data").is_dir() {
        let data = self::names(&place.join("data")).map_err(|source| io_error(&place, "read the folder", source))?;
        let runs: std::collections::HashSet<String> = truth.runs.iter().map(|run| format!("{}.csv", run.id)).collect();
        foreign = data.into_iter().find(|name| !runs.contains(name)).map(|name| format!("data/{name}"));
    }
    match foreign {
        Some(name) => {
            Err(Error::FolderInUse { path: place, found: format!("beside a virtual campaign it holds {name}") })
        }
        None if !force && is_edited(&place, &truth) => {
            let found = "the virtual campaign in it was edited since it was written (--force replaces it)".to_owned();
            Err(Error::FolderInUse { path: place, found })
        }
        None => Ok(place),
    }
}

/// Whether any file is not as it was written, or is gone.
fn is_edited(place: &Path, truth: &Truth) -> bool {
    let runs: Vec<String> = truth.runs.iter().map(|run| format!("{}.csv", run.id)).collect();
    Digest::of_campaign(place, &runs).map_or(true, |digest| digest.to_string() != truth.digest)
}

fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        names.push(entry?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
