//! Arguments of `tempco fit` that say what is fitted.

use clap::ValueEnum;
use tempco_fit::{Method, SegmentModel, SegmentOverlap};
use tempco_set::Segmentation;

/// What is fitted.
#[derive(clap::Args)]
pub(crate) struct MethodArgs {
    /// Model of the bias, with temperature T and its rate T'
    #[arg(long, default_value = "auto", value_parser = model)]
    model: ModelArg,
    /// How neighbouring segments of static and composite are joined where they overlap. Default: linear
    #[arg(long, value_parser = overlap)]
    overlap: Option<OverlapArg>,
    /// Segments in degC of static and composite, such as "-15:15,5:35,25:60,50:80"; with auto, of the
    /// models that it is compared with. Default: the measured range is divided
    #[arg(long, value_name = "MIN:MAX,...", allow_hyphen_values = true)]
    segments: Option<Segmentation>,
    /// Removed: `auto` finds history terms where the logs show them
    #[arg(long, hide = true, value_parser = states)]
    states: Option<()>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModelArg {
    /// Per segment a0 + a1 T + a2 T^2
    Static,
    /// The paper's model: the same + a3 T' + a4 T T'
    Composite,
    /// These terms without jump or kink, two thermal lags and backlash, as the logs make most likely
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
}

impl MethodArgs {
    /// The method.
    pub(crate) fn method(&self) -> Method {
        let overlap = match self.overlap {
            Some(OverlapArg::None) => SegmentOverlap::None,
            Some(OverlapArg::Hard) => SegmentOverlap::Hard,
            Some(OverlapArg::Mean) => SegmentOverlap::Mean,
            None | Some(OverlapArg::Linear) => SegmentOverlap::Linear,
            Some(OverlapArg::Smooth) => SegmentOverlap::Smooth,
        };
        let segmentation = self.segments.clone();
        let segments = |model| Method::Segments {
            model,
            overlap,
            segmentation: segmentation.clone(),
        };
        match self.model {
            ModelArg::Static => segments(SegmentModel::Static),
            ModelArg::Composite => segments(SegmentModel::Composite),
            ModelArg::Auto => Method::Auto {
                overlap,
                segmentation,
            },
        }
    }
}

/// A value of an option; `removed` ones say what took their place.
fn value<T: ValueEnum>(given: &str, removed: &str, instead: &str) -> Result<T, String> {
    T::from_str(given, false).map_err(|_| {
        let names = T::value_variants().iter().filter_map(T::to_possible_value);
        let names: Vec<String> = names.map(|of| of.get_name().to_owned()).collect();
        match given == removed {
            true => format!("was removed: {instead}"),
            false => format!("expected one of {}", names.join(", ")),
        }
    })
}

fn model(given: &str) -> Result<ModelArg, String> {
    value(
        given,
        "spline",
        "auto, the default, has all that it had; leave the option out",
    )
}

fn overlap(given: &str) -> Result<OverlapArg, String> {
    value(
        given,
        "spline",
        "auto, the default, has no overlaps; leave the option out",
    )
}

fn states(_: &str) -> Result<(), String> {
    Err(
        "was removed: auto finds history terms where the logs show them; leave the option out"
            .into(),
    )
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

    /// Every option, given or not, with every model is in the method.
    #[test]
    fn options_are_in_the_method() {
        let or_not = |values: &[&'static str]| -> Vec<Option<&'static str>> {
            let given = values.iter().copied().map(Some);
            std::iter::once(None).chain(given).collect()
        };
        for model in ["static", "composite", "auto"] {
            for &overlap in &or_not(&["none", "hard", "mean", "linear", "smooth"]) {
                for &segments in &or_not(&["-15:15,5:35"]) {
                    check(model, overlap, segments);
                }
            }
        }
    }

    fn check(model: &str, overlap: Option<&str>, segments: Option<&str>) {
        let options = [
            ("--model", Some(model)),
            ("--overlap", overlap),
            ("--segments", segments),
        ];
        let given = options
            .iter()
            .filter_map(|(option, value)| Some(format!("{option}={}", (*value)?)));
        let args: Vec<String> = std::iter::once("fit".to_owned()).chain(given).collect();
        let args = Command::try_parse_from(&args).unwrap().method;
        let found = args.method();
        assert_eq!(found.model().name(), model);
        let own = if model == "auto" {
            "spline"
        } else {
            overlap.unwrap_or("linear")
        };
        assert_eq!(found.overlap().name(), own);
        let (Method::Segments { segmentation, .. } | Method::Auto { segmentation, .. }) = &found;
        assert_eq!(segmentation.is_some(), segments.is_some());
    }

    #[test]
    fn without_options_it_is_the_default_of_the_library() {
        let of = |args: &[&str]| Command::try_parse_from(args).unwrap().method.method();
        assert_eq!(of(&["fit"]), Method::AUTO);
        let composite = of(&["fit", "--model", "composite"]);
        assert_eq!(composite, Method::from(Model::Composite));
        assert_eq!(composite.overlap(), Overlap::Linear);
    }

    #[test]
    fn what_was_removed_says_what_took_its_place() {
        for option in ["--model=spline", "--overlap=spline", "--states=none"] {
            let error = Command::try_parse_from(["fit", option]).err().unwrap();
            let error = error.to_string();
            assert!(error.contains("was removed: auto"), "{error}");
        }
    }
}
