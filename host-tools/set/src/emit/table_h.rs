//! The table as a C header, for firmware in C: the same numbers as in `table.rs`, in the types of
//! `tempco.h`.

use std::fmt::Write as _;

use tempco::ThermalSettings;

use super::table_bin::axes;
use crate::escape::{c_literal, comment};
use crate::{ChannelSet, CoefficientSet};

/// The tables of a set as C99: `static const` structures of `tempco.h` with the numbers of
/// `table.rs`.
pub fn table_h(set: &CoefficientSet) -> String {
    let mut text = String::new();
    write_table_h(&mut text, set).expect("writing to a String cannot fail");
    text
}

fn write_table_h(out: &mut String, set: &CoefficientSet) -> std::fmt::Result {
    let channels = &set.channels;
    let axes = channels[0].axes.len();
    let guard = format!("TEMPCO_TABLE_{:08X}", set.crc32());
    writeln!(
        out,
        "/* Coefficient table, written by {}. Do not edit. */\n",
        comment(&set.provenance.tool)
    )?;
    writeln!(
        out,
        "#ifndef {guard}\n#define {guard}\n\n#include \"tempco.h\"\n"
    )?;
    let [serial, crc] = heading(set);
    writeln!(out, "{serial}\n{crc}")?;
    writeln!(out, "#define TEMPCO_CHANNELS {}", channels.len())?;
    writeln!(out, "#define TEMPCO_AXES {axes}\n")?;
    for (number, channel) in channels.iter().enumerate() {
        for line in axis_lines(number, channel) {
            writeln!(out, "{line}")?;
        }
        writeln!(out)?;
        write_cells(out, number, channel)?;
    }
    writeln!(
        out,
        "static const tempco_channel_t tempco_channels[TEMPCO_CHANNELS] = {{"
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_channel(out, number, set, channel)?;
    }
    writeln!(out, "}};\n\n#endif")
}

/// The lines by which a table is known to be of a set: serial number, CRC, and the names and units
/// of the axes of each channel.
pub(crate) fn identity(set: &CoefficientSet) -> Vec<String> {
    let channels = set.channels.iter().enumerate();
    let of_axes = channels.flat_map(|(number, channel)| axis_lines(number, channel));
    heading(set).into_iter().chain(of_axes).collect()
}

fn heading(set: &CoefficientSet) -> [String; 2] {
    [
        format!("#define TEMPCO_SERIAL {}", c_literal(&set.serial)),
        format!("#define TEMPCO_CRC 0x{:08x}u", set.crc32()),
    ]
}

fn axis_lines(number: usize, channel: &ChannelSet) -> impl Iterator<Item = String> {
    channel.axes.iter().enumerate().flat_map(move |(axis, of)| {
        let (name, unit) = (c_literal(&of.name), c_literal(of.unit.name()));
        [
            format!("#define TEMPCO_AXIS_NAME_{number}_{axis} {name}"),
            format!("#define TEMPCO_AXIS_UNIT_{number}_{axis} {unit}"),
        ]
    })
}

fn write_cells(out: &mut String, number: usize, channel: &ChannelSet) -> std::fmt::Result {
    let cells = &channel.table.cells;
    writeln!(
        out,
        "static const tempco_terms_t tempco_cells_{number}[{} * TEMPCO_AXES] = {{",
        cells.len()
    )?;
    for terms in cells.iter().flatten() {
        let [a, r, s] = [&terms.a[..], &terms.r, &terms.s].map(floats);
        writeln!(out, "    {{{{{a}}}, {{{r}}}, {{{s}}}}},")?;
    }
    writeln!(out, "}};\n")
}

/// Float literals.
fn floats(values: &[f32]) -> String {
    let literals: Vec<String> = values.iter().map(|value| format!("{value:?}f")).collect();
    literals.join(", ")
}

fn write_channel(
    out: &mut String,
    number: usize,
    set: &CoefficientSet,
    channel: &ChannelSet,
) -> std::fmt::Result {
    let table = &channel.table;
    writeln!(out, "    {{\n        {{")?;
    for (name, value) in ThermalSettings::NAMES.iter().zip(table.thermal.to_array()) {
        writeln!(out, "            {value:?}f, /* {name} */")?;
    }
    writeln!(out, "        }},")?;
    let temps = [
        table.first_edge_c,
        table.last_edge_c,
        table.t_min_c,
        table.t_max_c,
        set.settings.thermal_period_s as f32,
    ];
    writeln!(out, "        {},", floats(&temps))?;
    let counts = [table.cells.len(), channel.axes.len()];
    writeln!(
        out,
        "        {},\n        {},\n        {{",
        counts[0], counts[1]
    )?;
    for axis in axes(set, channel).iter().flatten() {
        let numbers = [
            axis.scale_factor_arcsec,
            axis.row_noise,
            axis.row_noise_interval_s,
            axis.rezero_limit,
        ];
        let [numbers, gains] = [&numbers[..], &axis.play_gains].map(floats);
        writeln!(out, "            {{{numbers}, {{{gains}}}}},")?;
    }
    writeln!(out, "        }},\n        tempco_cells_{number},\n    }},")
}
