//! Arguments that must be known before logs are summarised.

use tempco::ThermalSettings;
use tempco_fit::{LagSearch, PlanOptions};
use tempco_set::Stretch;

use crate::shared_args::averaging_time;

/// What must be known before logs are summarised.
#[derive(clap::Args)]
pub(crate) struct PlanArgs {
    /// Time constant of the rate estimator, in s. Default: fitted for auto, else 60
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    rate_tau: Option<f32>,
    /// Share of the lag that is compensated, in u = T - kappa (T - L), with L the filtered T.
    /// Default: fitted for auto, else 0 as in the paper
    #[arg(long, allow_negative_numbers = true)]
    kappa: Option<f32>,
    /// Leave a stretch of time out of the fit, in s, in every log. May be repeated
    #[arg(long, value_name = "T1:T2", value_parser = stretch, allow_hyphen_values = true)]
    exclude: Vec<Stretch>,
    /// Keep spikes and disturbances in the fit
    #[arg(long)]
    keep_outliers: bool,
    /// Fastest change of temperature that a unit can have, in degC/min. Default: 30
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    max_slew: Option<f32>,
    /// Averaging time of the bias stability, in s. Default: 100
    #[arg(long, value_name = "S", value_parser = averaging_time, allow_negative_numbers = true)]
    tau: Option<f64>,
}

fn stretch(text: &str) -> Result<Stretch, String> {
    let ends = text.split_once(':').and_then(|(from, to)| {
        let (from_s, to_s) = (from.trim().parse().ok()?, to.trim().parse().ok()?);
        (from_s < to_s).then_some(Stretch { from_s, to_s })
    });
    ends.ok_or_else(|| "expected T1:T2 in s, T1 before T2".to_owned())
}

impl PlanArgs {
    /// The plan of logs that are read with this angle per pulse \[arcsec\].
    pub(crate) fn options(&self, scale_factor_arcsec: Option<f64>) -> PlanOptions {
        let default = PlanOptions::default();
        let thermal = default.thermal;
        PlanOptions {
            thermal: ThermalSettings {
                max_slew_c_per_min: self.max_slew.unwrap_or(thermal.max_slew_c_per_min),
                tau_s: self.rate_tau.unwrap_or(thermal.tau_s),
                kappa: self.kappa.unwrap_or(thermal.kappa),
                ..thermal
            },
            search: LagSearch {
                tau: self.rate_tau.is_none(),
                kappa: self.kappa.is_none(),
            },
            exclude: self.exclude.clone(),
            robust: !self.keep_outliers,
            scale_factor_arcsec,
            tau_s: self.tau.unwrap_or(default.tau_s),
        }
    }

    /// An option that was given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let options = [
            ("--rate-tau", self.rate_tau.is_some()),
            ("--kappa", self.kappa.is_some()),
            ("--exclude", !self.exclude.is_empty()),
            ("--keep-outliers", self.keep_outliers),
            ("--max-slew", self.max_slew.is_some()),
            ("--tau", self.tau.is_some()),
        ];
        let given = options.iter().find(|(_, is_given)| *is_given);
        given.map(|(option, _)| *option)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        plan: PlanArgs,
    }

    fn plan(args: &[&str]) -> PlanArgs {
        let args = std::iter::once("fit").chain(args.iter().copied());
        Command::try_parse_from(args).unwrap().plan
    }

    /// What `--help` says of them is so.
    #[test]
    fn without_options_it_is_the_default_of_the_library() {
        let options = plan(&[]).options(None);
        assert_eq!(options, PlanOptions::default());
        assert_eq!(options.thermal.max_slew_c_per_min, 30.0);
        assert_eq!((options.thermal.tau_s, options.tau_s), (60.0, 100.0));
        assert_eq!(plan(&[]).given(), None);
    }

    /// Every option changes the plan, and only what it is for.
    #[test]
    fn options_are_in_the_plan() {
        let default = PlanOptions::default();
        type Change = fn(&mut PlanOptions);
        let changes: [(&str, Change); 6] = [
            ("--rate-tau=90", |of| {
                of.thermal.tau_s = 90.0;
                of.search.tau = false;
            }),
            ("--kappa=0.5", |of| {
                of.thermal.kappa = 0.5;
                of.search.kappa = false;
            }),
            ("--exclude=1:2", |of| {
                of.exclude = vec![Stretch {
                    from_s: 1.0,
                    to_s: 2.0,
                }];
            }),
            ("--keep-outliers", |of| of.robust = false),
            ("--max-slew=3", |of| of.thermal.max_slew_c_per_min = 3.0),
            ("--tau=10", |of| of.tau_s = 10.0),
        ];
        for (option, change) in changes {
            let mut expected = default.clone();
            change(&mut expected);
            let args = plan(&[option]);
            assert_eq!(args.options(None), expected, "{option}");
            let name = option.split('=').next();
            assert_eq!(args.given(), name, "{option}");
        }
    }
}
