//! Which columns of a header are time, temperatures and axes, and in which units.

use std::collections::HashSet;

use super::axis_columns::{AxisColumn, find_axes};
use super::channel_columns::{ChannelColumns, assign, texts_of};
use super::doubt::{Doubt, DoubtKind};
use super::excerpt::excerpt;
use super::filter_columns::{NO_INSTANCES, find_filters};
use super::known::{Signs, recognise};
use super::mapping::{self, Filter, Mapping};
use super::reading::Reading;
use super::temp_columns::{FoundTemp, TempSource, find_temps};
use super::time::TimeUnit;
use super::time_column::find_time;

/// The columns that are read.
#[derive(Debug)]
pub(crate) struct Columns {
    pub(crate) time: usize,
    pub(crate) time_unit: TimeUnit,
    pub(crate) channels: Vec<ChannelColumns>,
    pub(crate) filters: Vec<Filter>,
    /// The source that was chosen, of a layout with several.
    pub(crate) instance: Option<u32>,
    /// The column that numbers the sources.
    pub(crate) source_position: Option<usize>,
    /// The sources of which none was chosen, and what to do.
    pub(crate) several: Option<(Vec<u32>, String)>,
    pub(crate) ignored: Vec<String>,
    pub(crate) reading: Reading,
}

impl Columns {
    /// Finds the columns: those named by the user, else those of a mapping that was kept and fits,
    /// else those of a known layout, else by their names.
    ///
    /// # Errors
    /// What is wrong with the header, and which option helps.
    pub(crate) fn find(
        signs: &Signs,
        given: &Mapping,
        kept: &[Mapping],
        joined: Option<(Vec<FoundTemp>, String)>,
    ) -> Result<Self, String> {
        let header = signs.header;
        check_names(header)?;
        let fitting = kept.iter().find(|mapping| fits(mapping, header));
        let own = match fitting {
            // Its temperatures are columns of the joined log.
            Some(kept) if kept.join.is_some() => given.or(&Mapping {
                temp: Vec::new(),
                ..kept.clone()
            }),
            Some(kept) => given.or(kept),
            None => given.clone(),
        };
        // A known layout gives what is not named.
        let is_complete = own.time.is_some() && !own.axis.is_empty() && !own.temp.is_empty();
        let is_plain = header.iter().any(|name| name == "time_s");
        let known = match recognise(signs, !own.axis.is_empty()) {
            _ if is_plain => None,
            // Its source still counts.
            Err(_) if is_complete => None,
            known => known?,
        };
        let mapping = match &known {
            Some(known) => own.or(&known.mapping),
            None => own,
        };

        let time = find_time(signs, mapping.time.as_deref())?;
        // A joined log that was kept is for a log without temperatures of its own.
        let own_temps = || find_temps(header, &mapping.temp, known.as_ref());
        let is_wanted = given.join.is_some() || own_temps().is_err();
        let (temps, join) = match joined.filter(|_| is_wanted) {
            Some((temps, file)) => (Ok(temps), Some(file)),
            None => (own_temps(), None),
        };
        let (temps, axes) = match (temps, find_axes(header, &mapping.axis)) {
            (Ok(temps), Ok(axes)) => (temps, axes),
            (Err(of_temps), Err(of_axes)) => return Err(format!("{of_axes}; and {of_temps}")),
            (Err(error), _) | (_, Err(error)) => return Err(error),
        };
        let source_position = known.as_ref().and_then(|known| known.source);
        let source_position = source_position.and_then(|name| mapping::position(header, name).ok());
        let instance = match mapping.instance {
            // A kept number counts where sources have numbers.
            Some(_) if source_position.is_none() && !signs.has_instances => match given.instance {
                Some(_) => return Err(NO_INSTANCES.to_owned()),
                None => None,
            },
            instance => instance,
        };
        let (filters, several) = find_filters(signs, &mapping.filter, source_position, instance)?;

        let (axes, axis_texts): (Vec<AxisColumn>, Vec<Option<String>>) = axes.into_iter().unzip();
        let used: HashSet<usize> = std::iter::once(time.0)
            .chain(temps.iter().filter_map(|temp| match temp.source {
                TempSource::Column(position) => Some(position),
                TempSource::Joined(_) => None,
            }))
            .chain(axes.iter().map(|axis| axis.position))
            .chain(filters.iter().map(|filter| filter.position))
            .chain(source_position)
            .collect();
        let ignored = header.iter().enumerate();
        let ignored =
            ignored.filter(|(position, name)| !used.contains(position) && !name.is_empty());
        let ignored = ignored.map(|(_, name)| name.clone()).collect();
        let own_correction = known.as_ref().and_then(|known| known.warning);
        let own_correction = own_correction.map(|detail| Doubt {
            kind: DoubtKind::OwnCorrection,
            detail: detail.to_owned(),
        });
        let temp_texts = texts_of(&temps, &axes);
        let used_mapping = Mapping {
            time: time.2,
            temp: temp_texts,
            axis: axis_texts.into_iter().flatten().collect(),
            filter: mapping.filter,
            instance,
            join,
        };
        Ok(Self {
            time: time.0,
            time_unit: time.1,
            channels: assign(temps, axes)?,
            filters,
            instance,
            source_position,
            several,
            ignored,
            reading: Reading {
                layout: known.as_ref().map(|known| known.name.to_owned()),
                notes: Vec::new(),
                doubts: own_correction.into_iter().collect(),
                mapping: (!used_mapping.is_empty()).then_some(used_mapping),
            },
        })
    }

    /// Finds time and temperatures of a log that is joined: each temperature is a channel, without
    /// axes.
    pub(crate) fn of_joined(signs: &Signs, given: &Mapping) -> Result<Self, String> {
        let header = signs.header;
        check_names(header)?;
        // `--time` may name the column of the log only.
        let time = given.time.as_deref();
        let time = time.filter(|text| mapping::time(text, header).is_ok());
        let temps = find_temps(header, &given.temp, None)?;
        let (time, time_unit, _) = find_time(signs, time)?;
        let channels = temps.into_iter().map(|temp| ChannelColumns {
            column: temp.column,
            temp: temp.source,
            to_deg_c: temp.to_deg_c,
            axes: Vec::new(),
        });
        Ok(Self {
            time,
            time_unit,
            channels: channels.collect(),
            filters: Vec::new(),
            instance: None,
            source_position: None,
            several: None,
            ignored: Vec::new(),
            reading: Reading::default(),
        })
    }
}

fn check_names(header: &[String]) -> Result<(), String> {
    let mut names = HashSet::new();
    let mut named = header.iter().filter(|name| !name.is_empty());
    match named.find(|name| !names.insert(name.as_str())) {
        Some(twice) => Err(format!("two columns are named `{}`", excerpt(twice))),
        None => Ok(()),
    }
}

/// Whether a header has all columns of a mapping.
fn fits(kept: &Mapping, header: &[String]) -> bool {
    let has_temps = kept.join.is_some()
        || kept
            .temp
            .iter()
            .all(|text| mapping::temp(text, header).is_ok());
    has_temps
        && kept
            .time
            .iter()
            .all(|text| mapping::time(text, header).is_ok())
        && kept
            .axis
            .iter()
            .all(|text| mapping::axis(text, header).is_ok())
        && kept
            .filter
            .iter()
            .all(|text| mapping::filter(text, header).is_ok())
}
