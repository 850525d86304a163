//! Temperatures with the axes that belong to them.

use std::collections::HashSet;

use super::axis_columns::AxisColumn;
use super::excerpt::excerpt;
use super::names::Linear;
use super::temp_columns::{FoundTemp, Owner, TempSource};

/// The columns of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelColumns {
    /// Name of the temperature column.
    pub column: String,
    /// Where the temperature comes from.
    pub(crate) temp: TempSource,
    /// From its values to degC.
    pub(crate) to_deg_c: Linear,
    /// The axes.
    pub axes: Vec<AxisColumn>,
}

/// Texts of temperatures in a mapping; a temperature of axes by the start of their names is given to
/// each of them.
pub(crate) fn texts_of(temps: &[FoundTemp], axes: &[AxisColumn]) -> Vec<String> {
    let mut texts = Vec::new();
    for temp in temps {
        match (&temp.text, &temp.owner) {
            (Some(text), Owner::Start(_)) => {
                let owned = axes.iter().filter(|axis| temp.owner.owns(&axis.name));
                texts.extend(owned.map(|axis| format!("{}={text}", axis.name)));
            }
            (Some(text), _) => texts.push(text.clone()),
            (None, _) => {}
        }
    }
    texts
}

/// Gives each axis its temperature.
pub(crate) fn assign(
    temps: Vec<FoundTemp>,
    axes: Vec<AxisColumn>,
) -> Result<Vec<ChannelColumns>, String> {
    let channel = |temp: &FoundTemp| ChannelColumns {
        column: temp.column.clone(),
        temp: temp.source,
        to_deg_c: temp.to_deg_c,
        axes: Vec::new(),
    };
    if let [one] = &temps[..]
        && one.owner == Owner::All
    {
        let channel = channel(one);
        return Ok(vec![ChannelColumns { axes, ..channel }]);
    }
    // A temperature that is named for several axes is one channel.
    let mut channels: Vec<ChannelColumns> = Vec::new();
    let mut channel_of = Vec::new();
    for temp in &temps {
        let is_same =
            |other: &ChannelColumns| other.temp == temp.source && other.to_deg_c == temp.to_deg_c;
        let place = channels.iter().position(is_same);
        channel_of.push(place.unwrap_or(channels.len()));
        if place.is_none() {
            channels.push(channel(temp));
        }
    }
    let count_of_temps = channels.len();
    for axis in axes {
        let owners = temps.iter().zip(&channel_of);
        let owners = owners.filter(|(temp, _)| temp.owner.owns(&axis.name));
        let owners: HashSet<usize> = owners.map(|(_, channel)| *channel).collect();
        match (owners.len(), owners.iter().next()) {
            (1, Some(&channel)) => channels[channel].axes.push(axis),
            _ => {
                return Err(format!(
                    "{count_of_temps} temperature columns, and it is not clear which belongs to \
                     axis `{}`: choose one for all axes by --temp COLUMN, or one per axis by \
                     --temp AXIS=COLUMN",
                    excerpt(&axis.name)
                ));
            }
        }
    }
    let count = channels[0].axes.len();
    if channels.iter().any(|channel| channel.axes.len() != count) || count == 0 {
        return Err(
            "every temperature column must belong to the same number of axes: choose them by \
             --temp and --axis"
                .to_owned(),
        );
    }
    Ok(channels)
}
