//! The table as Rust source, `table.rs`.

use std::fmt::Write as _;

use tempco::{PLAYS, Terms, ThermalSettings};

use crate::escape::comment;
use crate::{AxisSet, ChannelSet, CoefficientSet, TableData};

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
        comment(&set.provenance.tool)
    )?;
    let [serial, crc, axis_names, axis_units] = identity(set);
    writeln!(out, "/// Serial number of the unit.\n{serial}")?;
    writeln!(out, "/// CRC-32P4 over the numbers of the tables.\n{crc}")?;
    writeln!(out, "/// Temperature channels.")?;
    writeln!(out, "pub const CHANNELS: usize = {};", channels.len())?;
    writeln!(out, "/// Axes per channel.")?;
    writeln!(out, "pub const AXES: usize = {axes};")?;
    writeln!(out, "/// Names of the axes.\n{axis_names}")?;
    writeln!(
        out,
        "/// Units of the axes and of their biases.\n{axis_units}\n"
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_cells(out, number, channel)?;
    }
    writeln!(out, "/// The tables, one per temperature channel.")?;
    writeln!(
        out,
        "pub static TABLES: [tempco::Table<'static, AXES>; CHANNELS] = ["
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_table(out, number, &channel.table)?;
    }
    writeln!(out, "];")
}

/// The lines by which a table is known to be of a set.
pub(crate) fn identity(set: &CoefficientSet) -> [String; 4] {
    let names = |name: fn(&AxisSet) -> &str| {
        let rows: Vec<Vec<&str>> = set
            .channels
            .iter()
            .map(|channel| channel.axes.iter().map(name).collect())
            .collect();
        format!("[[&str; AXES]; CHANNELS] = {rows:?};")
    };
    [
        format!("pub const SERIAL: &str = {:?};", set.serial),
        format!("pub const CRC: u32 = 0x{:08x};", set.crc32()),
        format!("pub const AXIS_NAMES: {}", names(|axis| &axis.name)),
        format!("pub const AXIS_UNITS: {}", names(|axis| axis.unit.name())),
    ]
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
        for Terms { a, r, s } in cell {
            writeln!(
                out,
                "        tempco::Terms {{ a: {a:?}, r: {r:?}, s: {s:?} }},"
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
    writeln!(
        out,
        "        const CALIBRATED: tempco::Table<'static, AXES> = match WHOLE.calibrated({:?}, {:?}) {checked};",
        table.t_min_c, table.t_max_c
    )?;
    let gains = |play: usize| -> Vec<f32> {
        table
            .play_gains
            .iter()
            .map(|of_axis| of_axis[play])
            .collect()
    };
    let gains: [Vec<f32>; PLAYS] = std::array::from_fn(gains);
    writeln!(
        out,
        "        match CALIBRATED.with_plays({gains:?}) {checked}"
    )?;
    writeln!(out, "    }},")
}
