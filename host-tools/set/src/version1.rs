//! Sets of version 1 of the format, which tempco 0.1 wrote, as sets of version 2.
//!
//! The conversion is exact: the table and its CRC stay. What the terms that came with version 2
//! need is set to none. A second thermal lag had another form in version 1, so it is refused.

use serde::Deserialize;
use serde_json::{Map, Value, json};
use tempco::{PLAYS, Terms, ThermalSettings};

use crate::FORMAT_VERSION;
use crate::model::COMPOSITE;

/// The head of a set, whatever the rest is.
#[derive(Deserialize)]
struct Head {
    format_version: u64,
}

/// A set of version 1 as the text of one of version 2; none where the text is not of version 1.
///
/// # Errors
/// Another version; a set that cannot be converted: fit again.
pub(crate) fn converted(text: &str) -> Result<Option<String>, String> {
    // A text that has no version is not read here either, and what it lacks is said there.
    let version = serde_json::from_str(text).map(|Head { format_version }| format_version);
    match version.unwrap_or(FORMAT_VERSION.into()) {
        1 => {}
        version if version == u64::from(FORMAT_VERSION) => return Ok(None),
        version => {
            return Err(format!(
                "version {version} of the format: expected {FORMAT_VERSION}, or 1 of tempco 0.1"
            ));
        }
    }
    // Where something is not as expected it stays as it is: reading it as version 2 says what.
    let Ok(mut set) = serde_json::from_str::<Value>(text) else {
        return Ok(None);
    };
    set["format_version"] = json!(FORMAT_VERSION);
    for channel in of_list(set.get_mut("channels")) {
        convert_table(channel)?;
        rename(channel);
        for axis in of_list(channel.get_mut("axes")) {
            for key in ["polynomials", "sigmas"] {
                for part in of_list(axis.get_mut(key)) {
                    insert(part, "s", json!(vec![0.0; Terms::LAG]));
                }
            }
            if let Some(gains) = axis.get_mut("gains").and_then(Value::as_array_mut) {
                gains.resize(PLAYS, json!({"gain": 0.0, "sigma": 0.0}));
            }
        }
    }
    // The core took a temperature at every row.
    let interval_s = |input: &Value| input.get("interval_s").and_then(Value::as_f64);
    let inputs = set.pointer("/provenance/inputs").and_then(Value::as_array);
    let longest_s = inputs
        .into_iter()
        .flatten()
        .filter_map(interval_s)
        .fold(0.0, f64::max);
    if let Some(settings) = set.get_mut("settings") {
        insert(settings, "thermal_period_s", json!(longest_s));
    }
    Ok(Some(set.to_string()))
}

fn convert_table(channel: &mut Value) -> Result<(), String> {
    let axes = channel
        .get("axes")
        .and_then(Value::as_array)
        .map_or(0, Vec::len);
    let Some(table) = channel.get_mut("table").and_then(Value::as_object_mut) else {
        return Ok(());
    };
    if table.remove("slow_parts").is_some() {
        return Err(
            "a set of tempco 0.1 with a second thermal lag (slow_parts), which has another form \
             now: fit again"
                .to_owned(),
        );
    }
    let plays = table.remove("plays");
    let plays = plays.as_ref().and_then(Value::as_array);
    let plays = plays.map_or(&[][..], Vec::as_slice);
    for terms in of_list(table.get_mut("cells")).flat_map(|cell| of_list(Some(cell))) {
        if let Some(terms) = terms
            .as_array_mut()
            .filter(|terms| terms.len() == COMPOSITE)
        {
            terms.resize(Terms::COUNT, json!(0.0));
        }
    }
    let gain = |play: usize, axis: usize| {
        let gains = plays.get(play).and_then(|play| play.get("gain"));
        gains
            .and_then(|gains| gains.get(axis))
            .cloned()
            .unwrap_or(json!(0.0))
    };
    let gains = |axis| (0..PLAYS).map(|play| gain(play, axis)).collect();
    let gains: Vec<Vec<Value>> = (0..axes).map(gains).collect();
    table.insert("play_gains".to_owned(), json!(gains));
    if let Some(thermal) = table.get_mut("thermal").and_then(Value::as_object_mut) {
        convert_thermal(thermal, plays);
    }
    Ok(())
}

fn convert_thermal(thermal: &mut Map<String, Value>, plays: &[Value]) {
    let none = ThermalSettings::DEFAULT.to_array();
    for (name, value) in ThermalSettings::NAMES.iter().zip(none) {
        thermal.entry(*name).or_insert(json!(value));
    }
    // The lag-compensated temperature dragged the plays.
    for (name, play) in ["half_width1_c", "half_width2_c"].iter().zip(plays) {
        let width_c = play.get("half_width_c").cloned().unwrap_or(Value::Null);
        thermal.insert((*name).to_owned(), width_c);
    }
    if let (false, Some(kappa)) = (plays.is_empty(), thermal.get("kappa").cloned()) {
        thermal.insert("play_kappa".to_owned(), kappa);
    }
}

/// Names of keys in version 1 and now.
const RENAMED: [(&str, &str); 3] = [
    ("slow_tau_s", "tau2_s"),
    ("legs", "soaks_and_ramps"),
    ("screening", "outliers"),
];

/// Gives the keys of all objects within a value their names of now.
fn rename(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(rename),
        Value::Object(fields) => {
            for (old, new) in RENAMED {
                if let Some(value) = fields.remove(old) {
                    fields.insert(new.to_owned(), value);
                }
            }
            fields.iter_mut().for_each(|(_, value)| rename(value));
        }
        _ => {}
    }
}

fn insert(part: &mut Value, key: &str, value: Value) {
    if let Some(part) = part.as_object_mut() {
        part.insert(key.to_owned(), value);
    }
}

/// The elements of a list; nothing where it is none.
fn of_list(value: Option<&mut Value>) -> impl Iterator<Item = &mut Value> {
    value.and_then(Value::as_array_mut).into_iter().flatten()
}
