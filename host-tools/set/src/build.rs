//! Puts fitted polynomials together into a set with its table.

use tempco::ThermalSettings;

use crate::model::AxisModel;
use crate::segment::{Overlap, Segmentation};
use crate::tabulate::tabulate;
use crate::{
    AxisSet, ChannelSet, CoefficientSet, FORMAT_VERSION, GainSet, PlayData, Provenance, Screening,
    SegmentSet, Selection, Settings, SlowPartData, TableData, Term,
};

/// A channel before its table is made.
pub struct Fitted {
    /// Name of the temperature column.
    pub temperature: String,
    /// The segments and what was found in each.
    pub segments: Vec<SegmentSet>,
    /// The axes, with the polynomials of all segments.
    pub axes: Vec<AxisSet>,
    /// History terms, each with its largest value in the fit \[degC\]; their gains are with the
    /// axes.
    pub history: Vec<(Term, f32)>,
    /// What was left out of the fit, and what was found in the logs.
    pub screening: Option<Screening>,
    /// What the model was chosen from.
    pub selection: Option<Selection>,
}

/// Makes the channel's table; `calibrated_c` is the range of temperatures that was measured.
///
/// The bias of an accelerometer contains gravity, which belongs to the output. So its polynomials
/// are shifted: what is taken out is the change of the bias about the reference temperature.
pub fn channel(
    mut fitted: Fitted,
    segmentation: &Segmentation,
    overlap: Overlap,
    thermal: ThermalSettings,
    calibrated_c: (f32, f32),
) -> ChannelSet {
    let reference_c = f64::from(thermal.reference_c);
    let accelerometers = fitted.axes.iter_mut();
    for axis in accelerometers.filter(|axis| axis.unit.is_acceleration()) {
        let model = AxisModel {
            polynomials: &axis.polynomials,
            overlap,
        };
        let constant = model.static_bias(segmentation, reference_c);
        for polynomial in &mut axis.polynomials {
            polynomial.a[0] -= constant;
        }
        axis.reference_c = Some(reference_c);
    }
    let models: Vec<AxisModel> = fitted
        .axes
        .iter()
        .map(|axis| AxisModel {
            polynomials: &axis.polynomials,
            overlap,
        })
        .collect();
    let rates = (
        f64::from(thermal.rate_min_c_per_min),
        f64::from(thermal.rate_max_c_per_min),
    );
    let cells = tabulate(segmentation, &models, rates);
    let (plays, slow_parts) = history(&fitted);
    let (first_edge_c, last_edge_c) = segmentation.range_c();
    let (first_edge_c, last_edge_c) = (first_edge_c as f32, last_edge_c as f32);
    ChannelSet {
        temperature: fitted.temperature,
        segments: fitted.segments,
        table: TableData {
            thermal,
            first_edge_c,
            last_edge_c,
            t_min_c: calibrated_c.0.max(first_edge_c),
            t_max_c: calibrated_c.1.min(last_edge_c),
            cells: cells.cells,
            plays,
            slow_parts,
        },
        axes: fitted.axes,
        table_deviation: cells.deviation,
        boundary_moved_c: cells.moved_c,
        screening: fitted.screening,
        selection: fitted.selection,
    }
}

/// The history terms as the core has them.
fn history(fitted: &Fitted) -> (Vec<PlayData>, Vec<SlowPartData>) {
    let (mut plays, mut slow_parts) = (Vec::new(), Vec::new());
    for (position, &(term, most_c)) in fitted.history.iter().enumerate() {
        let axes = fitted.axes.iter();
        let gain = axes.map(|axis| axis.gains[position].gain as f32).collect();
        match term {
            Term::Play { half_width_c } => plays.push(PlayData {
                half_width_c: half_width_c as f32,
                gain,
            }),
            Term::SlowPart { tau_s } => slow_parts.push(SlowPartData {
                tau_s: tau_s as f32,
                limit_c: most_c,
                gain,
            }),
        }
    }
    (plays, slow_parts)
}

/// Puts the channels together and seals them with the CRC.
pub fn set(
    serial: String,
    provenance: Provenance,
    settings: Settings,
    mut channels: Vec<ChannelSet>,
) -> CoefficientSet {
    level_history(&mut channels);
    let mut set = CoefficientSet {
        format: "tempco-coefficients".to_owned(),
        format_version: FORMAT_VERSION,
        serial,
        provenance,
        settings,
        channels,
        table_crc32: String::new(),
        sign_offs: Vec::new(),
    };
    set.table_crc32 = format!("{:08x}", set.crc32());
    set
}

/// Gives all channels as many plays and second lags as the one with the most, by terms without
/// gain: firmware has one type of table for all channels.
fn level_history(channels: &mut [ChannelSet]) {
    let most = |count: fn(&ChannelSet) -> usize| channels.iter().map(count).max().unwrap_or(0);
    let plays = most(|channel| channel.table.plays.len());
    let slow_parts = most(|channel| channel.table.slow_parts.len());
    for channel in channels {
        let axes = channel.axes.len();
        let table = &mut channel.table;
        let before = table.plays.len();
        let gain = vec![0.0; axes];
        table.plays.resize(
            plays,
            PlayData {
                half_width_c: 0.0,
                gain: gain.clone(),
            },
        );
        table.slow_parts.resize(
            slow_parts,
            SlowPartData {
                tau_s: table.thermal.tau_s,
                limit_c: 0.0,
                gain,
            },
        );
        for axis in &mut channel.axes {
            let of_slow = axis.gains.split_off(before.min(axis.gains.len()));
            axis.gains.resize(plays, GainSet::default());
            axis.gains.extend(of_slow);
            axis.gains.resize(plays + slow_parts, GainSet::default());
        }
    }
}

/// The name and version that go into provenance.
pub fn tool() -> String {
    concat!("tempco ", env!("CARGO_PKG_VERSION")).to_owned()
}

/// The present time; `SOURCE_DATE_EPOCH` overrules it where output must be reproducible.
pub fn now() -> String {
    let fixed = std::env::var("SOURCE_DATE_EPOCH")
        .ok()
        .and_then(|seconds| jiff::Timestamp::from_second(seconds.parse().ok()?).ok());
    let time = fixed.unwrap_or_else(jiff::Timestamp::now);
    time.strftime("%Y-%m-%dT%H:%M:%SZ").to_string()
}
