//! Arguments of `tempco fit` that say what is fitted.

use anyhow::{Result, bail, ensure};
use clap::ValueEnum;
use tempco::ThermalSettings;
use tempco_fit::{Method, SegmentModel, SegmentOverlap, SplineSearch};
use tempco_set::Segmentation;

/// What is fitted. An option that the model does not use is refused.
#[derive(clap::Args)]
pub(crate) struct MethodArgs {
    /// Model of the bias, with temperature T and its rate T'
    #[arg(long, value_enum, default_value = "composite")]
    model: ModelArg,
    /// How neighbouring segments are joined where they overlap. Default: linear; with --model spline,
    /// spline
    #[arg(long, value_enum)]
    overlap: Option<OverlapArg>,
    /// Segments in degC, such as "-15:15,5:35,25:60,50:80". Default: the measured range is divided
    #[arg(long, value_name = "MIN:MAX,...", allow_hyphen_values = true)]
    segments: Option<Segmentation>,
    /// Time constant of the rate estimator, in s. Default: fitted for spline and auto, else 60
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    rate_tau: Option<f32>,
    /// Share of the lag that is compensated, in u = T - kappa (T - L), with L the filtered T.
    /// Default: fitted for spline and auto, else 0 as in the paper
    #[arg(long, allow_negative_numbers = true)]
    kappa: Option<f32>,
    /// History terms, for spline and auto. Default: auto
    #[arg(long, value_enum)]
    states: Option<StatesArg>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModelArg {
    /// Per segment a0 + a1 T + a2 T^2
    Static,
    /// The paper's model: the same + a3 T' + a4 T T'
    Composite,
    /// These terms at a lag-compensated temperature, without jump or kink between segments
    Spline,
    /// The model that does best on soaks and ramps left out of the fit
    Auto,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OverlapArg {
    /// Each segment is fitted up to the middle of the overlap only
    None,
    /// The model switches in the middle of the overlap
    Hard,
    /// The mean of both segments
    Mean,
    /// A blend from one segment to the other, linear in temperature
    Linear,
    /// A blend without a kink at the ends of the overlap
    Smooth,
    /// Segments that meet in value and slope; for --model spline only
    Spline,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StatesArg {
    /// Plays (backlash) and a second thermal lag, where they lower the error on soaks and ramps left
    /// out of the fit; tried on logs with ramps of two rates or more
    Auto,
    /// No history terms
    None,
}

impl MethodArgs {
    /// The method.
    ///
    /// # Errors
    /// Names an option that the model does not use.
    pub(crate) fn method(&self) -> Result<Method> {
        let search = SplineSearch {
            tau: self.rate_tau.is_none(),
            kappa: self.kappa.is_none(),
            history: self.states != Some(StatesArg::None),
        };
        let segmentation = self.segments.clone();
        match self.model {
            ModelArg::Static => self.segments(SegmentModel::Static),
            ModelArg::Composite => self.segments(SegmentModel::Composite),
            ModelArg::Spline => {
                if let Some(overlap) = self.overlap {
                    ensure!(
                        overlap == OverlapArg::Spline,
                        "--overlap {} with --model spline: expected --overlap spline, or --model \
                         static, composite or auto",
                        name(&overlap)
                    );
                }
                Ok(Method::Spline {
                    segmentation,
                    search,
                })
            }
            ModelArg::Auto => Ok(Method::Auto {
                overlap: self.overlap_of_segments()?,
                segmentation,
                search,
            }),
        }
    }

    /// Settings of the thermal path, without those that are fitted.
    pub(crate) fn thermal(&self, max_slew_c_per_min: f32) -> ThermalSettings {
        let default = ThermalSettings::DEFAULT;
        ThermalSettings {
            max_slew_c_per_min,
            tau_s: self.rate_tau.unwrap_or(default.tau_s),
            kappa: self.kappa.unwrap_or(default.kappa),
            ..default
        }
    }

    fn segments(&self, model: SegmentModel) -> Result<Method> {
        if let Some(states) = self.states {
            bail!(
                "--states {} with --model {}: expected --model spline or auto",
                name(&states),
                name(&self.model)
            );
        }
        Ok(Method::Segments {
            model,
            overlap: self.overlap_of_segments()?,
            segmentation: self.segments.clone(),
        })
    }

    fn overlap_of_segments(&self) -> Result<SegmentOverlap> {
        match self.overlap {
            Some(OverlapArg::None) => Ok(SegmentOverlap::None),
            Some(OverlapArg::Hard) => Ok(SegmentOverlap::Hard),
            Some(OverlapArg::Mean) => Ok(SegmentOverlap::Mean),
            None | Some(OverlapArg::Linear) => Ok(SegmentOverlap::Linear),
            Some(OverlapArg::Smooth) => Ok(SegmentOverlap::Smooth),
            Some(OverlapArg::Spline) => bail!(
                "--overlap spline with --model {}: expected --model spline, or --overlap none, \
                 hard, mean, linear or smooth",
                name(&self.model)
            ),
        }
    }
}

/// A value as it is written on the command line.
fn name(value: &impl ValueEnum) -> String {
    let possible = value.to_possible_value().expect("no value is hidden");
    possible.get_name().to_owned()
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use tempco_set::{Model, Overlap};

    use super::*;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        method: MethodArgs,
    }

    /// The table in `docs/calibration.md`.
    fn is_allowed(model: &str, overlap: Option<&str>, states: Option<&str>) -> bool {
        let is_spline = overlap == Some("spline");
        match model {
            "static" | "composite" => !is_spline && states.is_none(),
            "spline" => overlap.is_none() || is_spline,
            "auto" => !is_spline,
            _ => unreachable!(),
        }
    }

    /// Every option, given or not, with every model: either it is in the method, or it is refused.
    #[test]
    fn what_a_model_does_not_use_is_refused() {
        let models = ["static", "composite", "spline", "auto"];
        let overlaps = ["none", "hard", "mean", "linear", "smooth", "spline"];
        let or_not = |values: &[&'static str]| -> Vec<Option<&'static str>> {
            let given = values.iter().copied().map(Some);
            std::iter::once(None).chain(given).collect()
        };
        let mut allowed = 0;
        for model in models {
            for &overlap in &or_not(&overlaps) {
                for &states in &or_not(&["auto", "none"]) {
                    for &segments in &or_not(&["-15:15,5:35"]) {
                        for &tau in &or_not(&["90"]) {
                            for &kappa in &or_not(&["0.5"]) {
                                let options = [
                                    ("--model", Some(model)),
                                    ("--overlap", overlap),
                                    ("--states", states),
                                    ("--segments", segments),
                                    ("--rate-tau", tau),
                                    ("--kappa", kappa),
                                ];
                                allowed += usize::from(check(&options));
                            }
                        }
                    }
                }
            }
        }
        // Of 672.
        assert_eq!(allowed, 8 * (2 * 6 + 2 * 3 + 6 * 3));
    }

    /// Whether some options are allowed, each with its value.
    fn check(options: &[(&str, Option<&str>); 6]) -> bool {
        let given = options
            .iter()
            .filter_map(|(option, value)| Some(format!("{option}={}", (*value)?)));
        let args: Vec<String> = std::iter::once("fit".to_owned()).chain(given).collect();
        let args = Command::try_parse_from(&args).unwrap().method;
        let [
            (_, model),
            (_, overlap),
            (_, states),
            (_, segments),
            (_, tau),
            (_, kappa),
        ] = *options;
        let model = model.unwrap();
        let found = match args.method() {
            Ok(found) => found,
            Err(error) => {
                assert!(!is_allowed(model, overlap, states), "{options:?}: {error}");
                let error = error.to_string();
                let (which, with) = error.split_once(": expected ").unwrap();
                let of = |option: &str, value: Option<&str>| {
                    which == format!("{option} {} with --model {model}", value.unwrap_or("-"))
                };
                assert!(
                    of("--overlap", overlap) || of("--states", states),
                    "{error}"
                );
                assert!(
                    with.contains("--model spline") || model == "spline",
                    "{error}"
                );
                return false;
            }
        };
        assert!(is_allowed(model, overlap, states), "{options:?}");
        assert_eq!(found.model().name(), model);
        let default = if model == "spline" {
            "spline"
        } else {
            "linear"
        };
        assert_eq!(found.overlap().name(), overlap.unwrap_or(default));
        let (given, search) = match &found {
            Method::Segments { segmentation, .. } => (segmentation, None),
            Method::Spline {
                segmentation,
                search,
            }
            | Method::Auto {
                segmentation,
                search,
                ..
            } => (segmentation, Some(search)),
        };
        assert_eq!(given.is_some(), segments.is_some());
        if let Some(search) = search {
            let expected = SplineSearch {
                tau: tau.is_none(),
                kappa: kappa.is_none(),
                history: states != Some("none"),
            };
            assert_eq!(*search, expected);
        }
        let thermal = args.thermal(3.0);
        assert_eq!(thermal.max_slew_c_per_min, 3.0);
        assert_eq!(thermal.tau_s, tau.map_or(60.0, |tau| tau.parse().unwrap()));
        let kappa = kappa.map_or(0.0, |kappa| kappa.parse().unwrap());
        assert_eq!(thermal.kappa, kappa);
        true
    }

    #[test]
    fn without_options_it_is_the_default_of_the_library() {
        let of = |args: &[&str]| Command::try_parse_from(args).unwrap().method;
        let composite = of(&["fit"]).method().unwrap();
        assert_eq!(composite, Method::from(Model::Composite));
        assert_eq!(composite.overlap(), Overlap::Linear);
        for (name, model) in [("spline", Model::Spline), ("auto", Model::Auto)] {
            let found = of(&["fit", "--model", name]).method().unwrap();
            assert_eq!(found, Method::from(model));
        }
    }
}
