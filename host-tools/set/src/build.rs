//! Puts fitted polynomials together into a set with its table.

use tempco::{PLAYS, ThermalSettings};

use crate::model::AxisModel;
use crate::segment::{Overlap, Segmentation};
use crate::tabulate::{Limits, tabulate};
use crate::{
    AxisSet, ChannelSet, CoefficientSet, FORMAT_VERSION, Outliers, Provenance, SegmentSet,
    Selection, Settings, TableData,
};

/// A channel before its table is made.
pub struct Fitted {
    /// Name of the temperature column.
    pub temperature: String,
    /// The segments and what was found in each.
    pub segments: Vec<SegmentSet>,
    /// The axes, with the polynomials of all segments.
    pub axes: Vec<AxisSet>,
    /// What was left out of the fit, and what was found in the logs.
    pub outliers: Option<Outliers>,
    /// What the model was chosen from.
    pub selection: Option<Selection>,
}

/// Makes the channel's table; `calibrated_c` is the range of temperatures that was measured,
/// `axes_of_unit` the number of axes of all channels.
///
/// The bias of an accelerometer contains gravity, which belongs to the output. So its polynomials
/// are shifted: what is taken out is the change of the bias about the reference temperature.
pub fn channel(
    mut fitted: Fitted,
    segmentation: &Segmentation,
    overlap: Overlap,
    thermal: ThermalSettings,
    calibrated_c: (f32, f32),
    axes_of_unit: usize,
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
    let cells = tabulate(segmentation, &models, &Limits::of(&thermal), axes_of_unit);
    let gains = |axis: &AxisSet| -> [f32; PLAYS] {
        std::array::from_fn(|play| axis.gains.get(play).map_or(0.0, |of| of.gain as f32))
    };
    let play_gains = fitted.axes.iter().map(gains).collect();
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
            play_gains,
        },
        axes: fitted.axes,
        table_deviation: cells.deviation,
        boundary_moved_c: cells.moved_c,
        outliers: fitted.outliers,
        selection: fitted.selection,
    }
}

/// Puts the channels together and seals them with the CRC.
pub fn set(
    serial: String,
    provenance: Provenance,
    settings: Settings,
    channels: Vec<ChannelSet>,
) -> CoefficientSet {
    let mut set = CoefficientSet {
        format: "tempco-coefficients".to_owned(),
        format_version: FORMAT_VERSION,
        serial,
        provenance,
        settings,
        channels,
        table_crc32: String::new(),
        set_crc32: String::new(),
        sign_offs: Vec::new(),
    };
    set.seal();
    set
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
