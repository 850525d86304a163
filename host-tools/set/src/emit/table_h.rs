//! The table as a C header, for firmware in C: the same numbers as in `table.rs`.

use std::fmt::Write as _;

use tempco::{MAX_AXES, Terms, ThermalSettings};

use super::table_bin::gains;
use crate::escape::{c_literal, comment};
use crate::{ChannelSet, CoefficientSet};

/// Type definitions, guarded on their own, so that tables of several units can be included.
const TYPES: &str = r#"#ifndef TEMPCO_TABLE_TYPES
#define TEMPCO_TABLE_TYPES

/* Coefficients of one axis in one cell, lowest power first, with z from 0 at the cold edge of the
   cell to 1 at its hot edge: bias = a[0] + a[1] z + a[2] z^2 + rate (r[0] + r[1] z). */
typedef struct {
    float a[STATIC]; /* unit of the axis */
    float r[RATE]; /* unit of the axis per degC/min */
} tempco_terms_t;

/* Settings of the thermal path. */
typedef struct {
    SETTINGS} tempco_thermal_t;

/* A hysteresis term: a contact c follows the lag-compensated temperature u at a distance of
   half_width_c at most; bias += gain (u - c). */
typedef struct {
    float half_width_c;
    float gain[GAINS]; /* of each axis, then 0; unit of the axis per degC */
} tempco_play_t;

/* A second thermal lag: s follows u with time constant tau_s;
   bias += gain (u - s), with u - s from -limit_c to limit_c. */
typedef struct {
    float tau_s;
    float limit_c;
    float gain[GAINS]; /* of each axis, then 0; unit of the axis per degC */
} tempco_slow_part_t;

/* One temperature channel. */
typedef struct {
    tempco_thermal_t thermal;
    float first_edge_c; /* cold edge of the first cell */
    float last_edge_c;  /* hot edge of the last cell; all cells have the same width */
    float t_min_c;      /* calibrated range, to which temperatures are clamped */
    float t_max_c;
    uint32_t cell_count;
    const tempco_terms_t *cells; /* all axes of the coldest cell, then all of the next */
    uint32_t play_count;
    const tempco_play_t *plays; /* null where there are none */
    uint32_t slow_part_count;
    const tempco_slow_part_t *slow_parts; /* null where there are none */
} tempco_channel_t;

#endif
"#;

/// The tables of a set as C99: `static const` structures with the numbers of `table.rs`.
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
        "#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n"
    )?;
    let fields = ThermalSettings::NAMES.map(|name| format!("float {name};\n"));
    let types = TYPES
        .replace("STATIC", &Terms::STATIC.to_string())
        .replace("RATE", &Terms::RATE.to_string())
        .replace("SETTINGS", &fields.join("    "))
        .replace("GAINS", &MAX_AXES.to_string());
    writeln!(out, "{types}")?;
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
        write_history(out, number, channel)?;
    }
    writeln!(
        out,
        "static const tempco_channel_t tempco_channels[TEMPCO_CHANNELS] = {{"
    )?;
    for (number, channel) in channels.iter().enumerate() {
        write_channel(out, number, channel)?;
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
        let [a, r] = [&terms.a[..], &terms.r].map(floats);
        writeln!(out, "    {{{{{a}}}, {{{r}}}}},")?;
    }
    writeln!(out, "}};\n")
}

/// The history terms; nothing where there are none, as C99 has no arrays without elements.
fn write_history(out: &mut String, number: usize, channel: &ChannelSet) -> std::fmt::Result {
    let table = &channel.table;
    let plays = table
        .plays
        .iter()
        .map(|play| (vec![play.half_width_c], gains(&play.gain)));
    let slow_parts = table
        .slow_parts
        .iter()
        .map(|part| (vec![part.tau_s, part.limit_c], gains(&part.gain)));
    for (name, terms) in [
        ("play", plays.collect::<Vec<_>>()),
        ("slow_part", slow_parts.collect()),
    ] {
        if terms.is_empty() {
            continue;
        }
        let count = terms.len();
        writeln!(
            out,
            "static const tempco_{name}_t tempco_{name}s_{number}[{count}] = {{"
        )?;
        for (settings, gains) in terms {
            let [settings, gains] = [&settings[..], &gains].map(floats);
            writeln!(out, "    {{{settings}, {{{gains}}}}},")?;
        }
        writeln!(out, "}};\n")?;
    }
    Ok(())
}

/// Float literals.
fn floats(values: &[f32]) -> String {
    let literals: Vec<String> = values.iter().map(|value| format!("{value:?}f")).collect();
    literals.join(", ")
}

/// The number of history terms and where they are.
fn pointer(name: &str, number: usize, count: usize) -> String {
    match count {
        0 => "0, 0".to_owned(),
        _ => format!("{count}, tempco_{name}_{number}"),
    }
}

fn write_channel(out: &mut String, number: usize, channel: &ChannelSet) -> std::fmt::Result {
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
    ];
    writeln!(
        out,
        "        {},\n        {}, tempco_cells_{number},\n        {},\n        {},\n    }},",
        floats(&temps),
        table.cells.len(),
        pointer("plays", number, table.plays.len()),
        pointer("slow_parts", number, table.slow_parts.len()),
    )
}
