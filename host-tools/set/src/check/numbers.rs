//! The range of every number of a set.

use super::ranges::{
    ANY, AT_LEAST_0, LAG_SHARES, LARGEST, ONE, SCALE_FACTORS_ARCSEC, all_in, all_within, within,
};
use crate::{
    AxisSet, AxisStatistics, Candidate, ChannelSet, CoefficientSet, CoefficientSigmas,
    HeldOutErrors, NoiseSet, Outliers, SegmentSet, Selection, Surpassed,
};

impl CoefficientSet {
    pub(super) fn check_numbers(&self) -> Result<(), String> {
        if let Some(scale_factor) = self.settings.scale_factor_arcsec {
            let key = "settings.scale_factor_arcsec";
            within(key, scale_factor, SCALE_FACTORS_ARCSEC)?;
        }
        within(
            "settings.thermal_period_s",
            self.settings.thermal_period_s,
            AT_LEAST_0,
        )?;
        for (number, input) in self.provenance.inputs.iter().enumerate() {
            let key = format!("provenance.inputs[{number}]");
            let times = [
                ("interval_s", input.interval_s),
                ("duration_s", input.duration_s),
            ];
            all_within(&key, &times, &AT_LEAST_0)?;
            for (number, finding) in input.findings.iter().enumerate() {
                let key = format!("{key}.findings[{number}]");
                within(format!("{key}.share"), finding.share, 0.0..=ONE)?;
                let times = [("from_s", finding.from_s), ("to_s", finding.to_s)];
                all_within(&key, &times, &ANY)?;
            }
        }
        for (number, sign_off) in self.sign_offs.iter().enumerate() {
            let key = format!("sign_offs[{number}].tau_s");
            within(key, sign_off.tau_s, AT_LEAST_0)?;
        }
        for (number, channel) in self.channels.iter().enumerate() {
            channel.check_numbers(&format!("channels[{number}]"))?;
        }
        Ok(())
    }
}

impl ChannelSet {
    fn check_numbers(&self, key: &str) -> Result<(), String> {
        let of_table = [
            ("table_deviation", self.table_deviation),
            ("boundary_moved_c", self.boundary_moved_c),
        ];
        all_within(key, &of_table, &AT_LEAST_0)?;
        for (number, segment) in self.segments.iter().enumerate() {
            segment.check(&format!("{key}.segments[{number}]"))?;
        }
        for (number, axis) in self.axes.iter().enumerate() {
            axis.check(&format!("{key}.axes[{number}]"), (self, number))?;
        }
        if let Some(outliers) = &self.outliers {
            outliers.check(&format!("{key}.outliers"))?;
        }
        if let Some(selection) = &self.selection {
            selection.check(&format!("{key}.selection"))?;
        }
        Ok(())
    }
}

impl SegmentSet {
    fn check(&self, key: &str) -> Result<(), String> {
        within(format_args!("{key}.condition"), self.condition, AT_LEAST_0)?;
        let Some(coverage) = &self.coverage else {
            return Ok(());
        };
        let key = format!("{key}.coverage");
        let (slowest, fastest) = (coverage.rate_min_c_per_min, coverage.rate_max_c_per_min);
        let sizes = [
            ("time_s", coverage.time_s),
            (
                "rate_independent_c_per_min",
                coverage.rate_independent_c_per_min,
            ),
        ];
        all_within(&key, &sizes, &AT_LEAST_0)?;
        within(format_args!("{key}.width"), coverage.width, 0.0..=ONE)?;
        within(format_args!("{key}.rate_min_c_per_min"), slowest, ANY)?;
        within(
            format_args!("{key}.rate_max_c_per_min"),
            fastest,
            slowest..=LARGEST,
        )
    }
}

impl AxisSet {
    /// Checks an axis by its number in its channel.
    fn check(&self, key: &str, place: (&ChannelSet, usize)) -> Result<(), String> {
        let (channel, _) = place;
        let polynomials = self.polynomials.iter().zip(&channel.segments);
        for (number, (polynomial, segment)) in polynomials.enumerate() {
            let key = format!("{key}.polynomials[{number}]");
            let segment = segment.range();
            let places = [
                ("centre_c", polynomial.centre_c, segment.centre_c()),
                (
                    "half_width_c",
                    polynomial.half_width_c,
                    segment.half_width_c(),
                ),
            ];
            for (name, found, expected) in places {
                within(
                    format_args!("{key}.{name}"),
                    found,
                    expected - 1e-6..=expected + 1e-6,
                )?;
            }
            all_in(&key, "a", &polynomial.a, &ANY)?;
            all_in(&key, "r", &polynomial.r, &ANY)?;
            all_in(&key, "s", &polynomial.s, &ANY)?;
        }
        let (sigmas, segments) = (self.sigmas.len(), channel.segments.len());
        if sigmas != 0 && sigmas != segments {
            return Err(format!(
                "{key}.sigmas: {sigmas} for {segments} segments: expected one for each, or none"
            ));
        }
        for (number, sigmas) in self.sigmas.iter().enumerate() {
            sigmas.check(&format!("{key}.sigmas[{number}]"))?;
        }
        self.check_gains(key, place)?;
        if let Some(NoiseSet { white, walk }) = self.noise {
            let noise = [("white", white), ("walk", walk)];
            all_within(&format!("{key}.noise"), &noise, &AT_LEAST_0)?;
        }
        if let Some(reference_c) = self.reference_c {
            within(format_args!("{key}.reference_c"), reference_c, ANY)?;
        }
        if let Some(held_out) = &self.held_out {
            held_out.check(&format!("{key}.held_out"))?;
        }
        if let Some(statistics) = &self.statistics {
            statistics.check(&format!("{key}.statistics"))?;
        }
        Ok(())
    }

    /// The gains equal the table's, and there are as many.
    fn check_gains(&self, key: &str, (channel, axis): (&ChannelSet, usize)) -> Result<(), String> {
        for (number, expected) in channel.table.play_gains[axis].into_iter().enumerate() {
            let key = format!("{key}.gains[{number}]");
            let gain = self.gains.get(number).copied().unwrap_or_default();
            within(format_args!("{key}.sigma"), gain.sigma, AT_LEAST_0)?;
            if gain.gain as f32 != expected {
                return Err(format!(
                    "{key}.gain is {:?}: expected {expected:?}, the gain in the table",
                    gain.gain
                ));
            }
        }
        Ok(())
    }
}

impl CoefficientSigmas {
    fn check(&self, key: &str) -> Result<(), String> {
        all_in(key, "a", &self.a, &AT_LEAST_0)?;
        all_in(key, "r", &self.r, &AT_LEAST_0)?;
        all_in(key, "s", &self.s, &AT_LEAST_0)?;
        let rows = self.correlation.iter();
        rows.enumerate().try_for_each(|(row, values)| {
            all_in(key, &format!("correlation[{row}]"), values, &(-ONE..=ONE))
        })
    }
}

impl HeldOutErrors {
    fn check(&self, key: &str) -> Result<(), String> {
        let errors = [
            ("none", Some(self.none)),
            ("cubic", self.cubic),
            ("static", self.static_model),
            ("composite", self.composite),
            ("chosen", self.chosen),
            ("excess_sigma", self.excess_sigma),
            ("left_out", self.left_out),
        ];
        let errors = errors.into_iter();
        let found: Vec<_> = errors
            .filter_map(|(name, error)| Some((name, error?)))
            .collect();
        all_within(key, &found, &AT_LEAST_0)?;
        let surpassed = self.surpassed.iter();
        surpassed
            .into_iter()
            .try_for_each(|of| of.check(&format!("{key}.surpassed")))
    }
}

impl Surpassed {
    fn check(&self, key: &str) -> Result<(), String> {
        let figures = [
            ("rmse", self.rmse),
            ("excess", self.excess),
            ("excess_sigma", self.excess_sigma),
        ];
        all_within(key, &figures, &AT_LEAST_0)
    }
}

impl AxisStatistics {
    fn check(&self, key: &str) -> Result<(), String> {
        let figures = [
            ("rmse_raw", self.rmse_raw),
            ("rmse_cubic", self.rmse_cubic),
            ("rmse_compensated", self.rmse_compensated),
            ("tau_s", self.tau_s),
            ("sigma_raw", self.sigma_raw),
            ("sigma_cubic", self.sigma_cubic),
            ("sigma_compensated", self.sigma_compensated),
            ("serial_factor", self.serial_factor.unwrap_or(0.0)),
        ];
        all_within(key, &figures, &AT_LEAST_0)
    }
}

impl Outliers {
    fn check(&self, key: &str) -> Result<(), String> {
        for (number, step) in self.steps.iter().enumerate() {
            let step_key = format!("{key}.steps[{number}]");
            all_within(
                &step_key,
                &[("time_s", step.time_s), ("size", step.size)],
                &ANY,
            )?;
        }
        if let Some(extent) = &self.extent {
            let key = format!("{key}.extent");
            let ways = [("heated_c", extent.heated_c), ("cooled_c", extent.cooled_c)];
            all_within(&key, &ways, &AT_LEAST_0)?;
            if let Some(fast) = &extent.too_fast {
                let key = format!("{key}.too_fast");
                within(format_args!("{key}.share"), fast.share, 0.0..=ONE)?;
                let numbers = [
                    ("rate_c_per_min", fast.rate_c_per_min),
                    ("limit_c_per_min", fast.limit_c_per_min),
                    ("from_s", fast.from_s),
                    ("to_s", fast.to_s),
                ];
                all_within(&key, &numbers, &ANY)?;
            }
        }
        let places = [
            ("spikes", &self.spikes),
            ("disturbances", &self.disturbances),
        ];
        let places = places.map(|(name, found)| found.iter().enumerate().map(move |of| (name, of)));
        for (name, (number, found)) in places.into_iter().flatten() {
            let key = format!("{key}.{name}[{number}]");
            within(format_args!("{key}.share"), found.share, 0.0..=ONE)?;
            let times = [("from_s", found.from_s), ("to_s", found.to_s)];
            all_within(&key, &times, &ANY)?;
        }
        let logs = self.constants.iter().enumerate();
        logs.into_iter()
            .try_for_each(|(log, values)| all_in(key, &format!("constants[{log}]"), values, &ANY))
    }
}

impl Selection {
    fn check(&self, key: &str) -> Result<(), String> {
        let rates = &self.ramp_rates_c_per_min;
        all_in(key, "ramp_rates_c_per_min", rates, &AT_LEAST_0)?;
        self.chosen.check(&format!("{key}.chosen"))?;
        let others = self.others.iter().enumerate();
        others
            .into_iter()
            .try_for_each(|(number, other)| other.check(&format!("{key}.others[{number}]")))
    }
}

impl Candidate {
    fn check(&self, key: &str) -> Result<(), String> {
        let sizes = [
            ("tau_s", self.tau_s),
            ("tau2_s", self.tau2_s.unwrap_or(0.0)),
            ("excess_sigma", self.excess_sigma),
        ];
        all_within(key, &sizes, &AT_LEAST_0)?;
        let shares = [
            ("kappa", self.kappa),
            ("kappa2", self.kappa2),
            ("play_kappa", self.play_kappa),
            ("play_kappa2", self.play_kappa2),
        ];
        all_within(key, &shares, &LAG_SHARES)?;
        within(format_args!("{key}.excess"), self.excess, ANY)?;
        all_in(key, "half_widths_c", &self.half_widths_c, &AT_LEAST_0)?;
        all_in(key, "rmse", &self.rmse, &AT_LEAST_0)
    }
}
