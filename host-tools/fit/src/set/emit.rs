//! Writes a set: `coefficients.json` and `table.rs`, both or neither.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use tempco::ThermalSettings;

use super::{ChannelSet, CoefficientSet, PlayData, SlowPartData, TableData};

/// The table as Rust source for `include!`: constants that a bad table would not let compile.
pub fn table_rs(set: &CoefficientSet) -> String {
    let mut text = String::new();
    write_table_rs(&mut text, set).expect("writing to a String cannot fail");
    text
}

fn write_table_rs(out: &mut String, set: &CoefficientSet) -> std::fmt::Result {
    let channels = &set.channels;
    let axes = channels[0].axes.len();
    writeln!(
        out,
        "// Coefficient table of unit {}, written by {}. Do not edit.\n",
        comment(&set.serial),
        set.provenance.tool
    )?;
    writeln!(out, "/// Serial number of the unit.")?;
    writeln!(out, "pub const SERIAL: &str = {:?};", set.serial)?;
    writeln!(out, "/// CRC-32P4 over the numbers of the tables.")?;
    writeln!(out, "pub const CRC: u32 = 0x{:08x};", set.crc32())?;
    writeln!(out, "/// Temperature channels.")?;
    writeln!(out, "pub const CHANNELS: usize = {};", channels.len())?;
    writeln!(out, "/// Axes per channel.")?;
    writeln!(out, "pub const AXES: usize = {axes};")?;
    let names = |name: fn(&super::AxisSet) -> &str| {
        let rows: Vec<Vec<&str>> = channels
            .iter()
            .map(|channel| channel.axes.iter().map(name).collect())
            .collect();
        format!("{rows:?}")
    };
    writeln!(out, "/// Names of the axes.")?;
    writeln!(
        out,
        "pub const AXIS_NAMES: [[&str; AXES]; CHANNELS] = {};",
        names(|axis| &axis.name)
    )?;
    writeln!(out, "/// Units of the axes and of their biases.")?;
    writeln!(
        out,
        "pub const AXIS_UNITS: [[&str; AXES]; CHANNELS] = {};\n",
        names(|axis| axis.unit.name())
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_cells(out, number, channel)?;
    }
    writeln!(out, "/// The tables, one per temperature channel.")?;
    let counts = match (
        channels[0].table.plays.len(),
        channels[0].table.slow_parts.len(),
    ) {
        (0, 0) => String::new(),
        (plays, slow_parts) => format!(", {plays}, {slow_parts}"),
    };
    writeln!(
        out,
        "pub static TABLES: [tempco::Table<'static, AXES{counts}>; CHANNELS] = ["
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_table(out, number, &channel.table)?;
    }
    writeln!(out, "];")
}

fn write_cells(out: &mut String, number: usize, channel: &ChannelSet) -> std::fmt::Result {
    let cells = &channel.table.cells;
    writeln!(
        out,
        "const CELLS_{number}: [[tempco::Terms; AXES]; {}] = [",
        cells.len()
    )?;
    for cell in cells {
        writeln!(out, "    [")?;
        for [a0, a1, a2, r0, r1] in cell {
            writeln!(
                out,
                "        tempco::Terms {{ a: [{a0:?}, {a1:?}, {a2:?}], r: [{r0:?}, {r1:?}] }},"
            )?;
        }
        writeln!(out, "    ],")?;
    }
    writeln!(out, "];\n")
}

fn write_table(out: &mut String, number: usize, table: &TableData) -> std::fmt::Result {
    writeln!(out, "    {{")?;
    writeln!(
        out,
        "        const THERMAL: tempco::Thermal = match tempco::Thermal::new(tempco::ThermalSettings {{"
    )?;
    for (name, value) in ThermalSettings::NAMES.iter().zip(table.thermal.to_array()) {
        writeln!(out, "            {name}: {value:?},")?;
    }
    let checked = "{ Ok(checked) => checked, Err(error) => panic!(\"{}\", error.message()) }";
    writeln!(out, "        }}) {checked};")?;
    writeln!(
        out,
        "        const WHOLE: tempco::Table<'static, AXES> = match tempco::Table::new(THERMAL, {:?}, {:?}, &CELLS_{number}) {checked};",
        table.first_edge_c, table.last_edge_c
    )?;
    let calibrated = format!(
        "match WHOLE.calibrated({:?}, {:?}) {checked}",
        table.t_min_c, table.t_max_c
    );
    if table.plays.is_empty() && table.slow_parts.is_empty() {
        writeln!(out, "        {calibrated}")?;
    } else {
        writeln!(
            out,
            "        const CALIBRATED: tempco::Table<'static, AXES> = {calibrated};"
        )?;
        writeln!(out, "        match CALIBRATED.with_history(")?;
        write_history(out, table)?;
        writeln!(out, "        ) {checked}")?;
    }
    writeln!(out, "    }},")
}

fn write_history(out: &mut String, table: &TableData) -> std::fmt::Result {
    writeln!(out, "            [")?;
    for PlayData { half_width_c, gain } in &table.plays {
        writeln!(
            out,
            "                tempco::Play {{ half_width_c: {half_width_c:?}, gain: {gain:?} }},"
        )?;
    }
    writeln!(out, "            ],\n            [")?;
    for SlowPartData {
        tau_s,
        limit_c,
        gain,
    } in &table.slow_parts
    {
        writeln!(
            out,
            "                tempco::SlowPart {{ tau_s: {tau_s:?}, limit_c: {limit_c:?}, gain: {gain:?} }},"
        )?;
    }
    writeln!(out, "            ],")
}

/// A serial number must not end the comment it stands in.
fn comment(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}

/// Writes `files` into `folder`, which is made if need be: all of them or, on any failure, none.
///
/// Each file is first written in full beside its place and then moved there; if a move fails, the
/// files moved before it are put back as they were.
///
/// # Errors
/// What the system says, with the path.
pub fn write_files(folder: &Path, files: &[(&str, &[u8])]) -> io::Result<()> {
    let at =
        |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", folder.display()));
    let is_new = !folder.exists();
    fs::create_dir_all(folder).map_err(at)?;
    let result = replace_all(folder, files);
    if result.is_err() && is_new {
        // Nothing is left behind of a folder made in vain; if it is not empty, it stays.
        let _ = fs::remove_dir(folder);
    }
    result.map_err(at)
}

fn replace_all(folder: &Path, files: &[(&str, &[u8])]) -> io::Result<()> {
    let mut written = Vec::new();
    for (name, contents) in files {
        let mut file = new_file_in(folder)?;
        file.write_all(contents)?;
        file.as_file().sync_all()?;
        let path = folder.join(name);
        // Moving a file to the name of a device or pipe would put the file in its place.
        if fs::metadata(&path).is_ok_and(|former| !former.is_file()) {
            return Err(io::Error::other(format!(
                "{name} is there and is not a regular file"
            )));
        }
        let former = match fs::read(&path) {
            Ok(former) => Some(former),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        written.push((file, path, former));
    }
    let mut moved = Vec::new();
    for (file, path, former) in written {
        match file.persist(&path) {
            Ok(_) => moved.push((path, former)),
            Err(error) => {
                for (path, former) in moved {
                    match former {
                        Some(former) => fs::write(path, former)?,
                        None => fs::remove_file(path)?,
                    }
                }
                return Err(error.error);
            }
        }
    }
    Ok(())
}

/// A temporary file that others may read once it has its name, as far as the user's mask allows.
fn new_file_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_files_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("new/set");
        write_files(&out, &[("a", b"1"), ("b", b"2")]).unwrap();
        assert_eq!(fs::read(out.join("b")).unwrap(), b"2");

        // A folder that is not there makes the second move fail, after the first one.
        assert!(write_files(&out, &[("a", b"3"), ("no/b", b"4")]).is_err());
        assert_eq!(fs::read(out.join("a")).unwrap(), b"1");
        assert!(write_files(&out, &[("c", b"3"), ("no/b", b"4")]).is_err());
        assert_eq!(fs::read_dir(&out).unwrap().count(), 2);

        // A folder where a file should go is seen before anything is moved.
        fs::remove_file(out.join("b")).unwrap();
        fs::create_dir(out.join("b")).unwrap();
        assert!(write_files(&out, &[("a", b"3"), ("b", b"4")]).is_err());
        assert_eq!(fs::read(out.join("a")).unwrap(), b"1");
        assert_eq!(fs::read_dir(&out).unwrap().count(), 2);
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
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), b"").unwrap();
        let error = write_files(&folder.path().join("file/set"), &[("a", b"1")]).unwrap_err();
        assert!(error.to_string().contains("file/set"), "{error}");
    }
}
