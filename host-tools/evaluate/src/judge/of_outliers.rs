//! What was left out of a fit, what should have been, and how far the logs go.

use tempco_set::{
    BiasStep, ChannelSet, Disturbance, Extent, Outliers, Rejection, RejectionCode, Warning,
    WarningCode,
};

use crate::text::figure;

/// So many steps of an axis in a log are not power cycles: something comes and goes.
const MANY_STEPS: usize = 4;

/// What the logs of a channel say against its fit.
pub(super) fn rejections(channel: &ChannelSet) -> Vec<Rejection> {
    let Some(found) = &channel.outliers else {
        return Vec::new();
    };
    let spoilt = found.spikes.iter().chain(&found.disturbances);
    let spoilt = spoilt.filter(|of| of.is_too_much());
    let spoilt = spoilt.map(|of| {
        Rejection::of_axis(
            RejectionCode::DisturbedShare,
            &of.axis,
            format_args!(
                "{}, are disturbed, more than may be left out; leave the time out by --exclude or \
                 record again",
                place(of)
            ),
        )
    });
    let leapt = found.steps.iter().filter(|step| step.large);
    let leapt = leapt.map(|step| {
        Rejection::of_axis(
            RejectionCode::LargeBiasStep,
            &step.axis,
            format_args!(
                "{}: the bias steps by {:+.3e} {} at {:.0} s, more than a unit at rest can; leave \
                 one side out by --exclude or record again",
                step.file,
                step.size,
                unit(channel, step),
                step.time_s
            ),
        )
    });
    let thin = found.extent.iter().filter(|extent| extent.is_too_thin());
    let thin = thin.map(|extent| Rejection {
        code: RejectionCode::ThinRun,
        axis: None,
        message: format!(
            "{}: the logs cover {} degC and hold {} means of 10 s; expected {} degC and {} means \
             or more",
            channel.temperature,
            extent.covered_c,
            extent.means,
            Extent::LEAST_COVERED_C,
            Extent::LEAST_MEANS
        ),
    });
    let many = many_steps(found);
    spoilt.chain(leapt).chain(many).chain(thin).collect()
}

/// Each axis that steps again and again, log by log.
fn many_steps(found: &Outliers) -> Vec<Rejection> {
    let of = |step: &BiasStep| (step.file.clone(), step.axis.clone());
    let mut places: Vec<_> = found.steps.iter().map(of).collect();
    places.sort_unstable();
    let runs = places.chunk_by(|a, b| a == b);
    let rejection = |run: &[(String, String)]| {
        let (file, axis) = &run[0];
        Rejection::of_axis(
            RejectionCode::ManyBiasSteps,
            axis,
            format_args!(
                "{file}: the bias steps {} times; look for a loose contact, or for a bias that \
                 jumps at a temperature",
                run.len()
            ),
        )
    };
    let many = runs.filter(|run| run.len() >= MANY_STEPS);
    many.map(rejection).collect()
}

/// "log.csv: 4.0 % of the rows, from 500 to 1400 s"
fn place(of: &Disturbance) -> String {
    format!(
        "{}: {:.1} % of the rows, from {:.0} to {:.0} s",
        of.file,
        100.0 * of.share,
        of.from_s,
        of.to_s
    )
}

fn unit(channel: &ChannelSet, step: &BiasStep) -> String {
    let axis = channel.axes.iter().find(|axis| axis.name == step.axis);
    axis.map_or(String::new(), |axis| axis.unit.to_string())
}

pub(super) fn warn(channel: &ChannelSet, found: &Outliers, warnings: &mut Vec<Warning>) {
    warn_of_rows(&channel.temperature, found, warnings);
    for step in &found.steps {
        let fate = match step.levelled {
            true => "its parts have constants of their own",
            false => "leave the stretch out by --exclude if it is not of the unit",
        };
        warnings.push(Warning {
            code: WarningCode::BiasStep,
            axis: Some(step.axis.clone()),
            message: format!(
                "{}: the bias of {} steps by {:+.3e} at {:.0} s; {fate}",
                step.file, step.axis, step.size, step.time_s
            ),
        });
    }
    if let Some(extent) = &found.extent {
        warn_of_extent(&channel.temperature, extent, warnings);
    }
}

/// Rows that were left out, with their places.
fn warn_of_rows(temperature: &str, found: &Outliers, warnings: &mut Vec<Warning>) {
    use WarningCode::{DisturbedRows, ExcludedRows, Spikes};
    let counts = [
        (
            ExcludedRows,
            found.excluded_rows,
            "in excluded stretches",
            &[][..],
        ),
        (Spikes, found.spike_rows, "spikes", &found.spikes[..]),
        (
            DisturbedRows,
            found.disturbed_rows,
            "disturbed for 10 s or more",
            &found.disturbances[..],
        ),
    ];
    for (code, rows, why, places) in counts.into_iter().filter(|(_, rows, ..)| *rows > 0) {
        let places: Vec<String> = places
            .iter()
            .map(|of| format!("; axis {}, {}", of.axis, place(of)))
            .collect();
        let places = places.concat();
        let message = format!("{temperature}: {rows} rows left out: {why}{places}");
        warnings.push(Warning::new(code, message));
    }
}

fn warn_of_extent(temperature: &str, extent: &Extent, warnings: &mut Vec<Warning>) {
    if extent.is_short() {
        let message = format!(
            "{temperature}: the logs hold {} means of 10 s; {} or more are better",
            extent.means,
            Extent::ENOUGH_MEANS
        );
        warnings.push(Warning::new(WarningCode::FewMeans, message));
    }
    if extent.is_one_way() {
        let message = format!(
            "{temperature}: the logs heat by {:.0} degC and cool by {:.0} degC; lag and hysteresis \
             show only in both directions",
            extent.heated_c, extent.cooled_c
        );
        warnings.push(Warning::new(WarningCode::OneDirection, message));
    }
    if let Some(fast) = &extent.too_fast {
        let message = format!(
            "{temperature}: {} changes by up to {} degC/min in {:.0} % of its means, from {:.0} \
             to {:.0} s; the core follows {} degC/min",
            fast.file,
            figure(fast.rate_c_per_min),
            100.0 * fast.share,
            fast.from_s,
            fast.to_s,
            figure(fast.limit_c_per_min)
        );
        warnings.push(Warning::new(WarningCode::FastTemperature, message));
    }
}
