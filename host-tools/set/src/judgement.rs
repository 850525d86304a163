//! The judgement on a set, as data: the verdict, what rejects the set, and what to know of it.
//!
//! `tempco-evaluate` makes it; every command and the report show it.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

/// What to do with a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing speaks against it.
    Accepted,
    /// Read the warnings, then decide.
    AcceptedWithWarnings,
    /// Do not use it.
    Rejected,
}

impl Verdict {
    /// The verdict as it is written in JSON and CSV.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::AcceptedWithWarnings => "accepted_with_warnings",
            Self::Rejected => "rejected",
        }
    }
}

/// Codes that stay the same from version to version, each with its word, what it means and what to do.
macro_rules! codes {
    ($(#[$doc:meta])* $name:ident {
        $($code:ident = $word:literal: $meaning:literal, $advice:literal;)+
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum $name {
            $(#[doc = $meaning] #[serde(rename = $word)] $code,)+
        }

        impl $name {
            /// All codes.
            pub const ALL: &[Self] = &[$(Self::$code),+];

            /// The code as it is written.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$code => $word,)+
                }
            }

            /// What was found, in a sentence.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Self::$code => $meaning,)+
                }
            }

            /// What to do about it.
            pub const fn advice(self) -> &'static str {
                match self {
                    $(Self::$code => $advice,)+
                }
            }
        }
    };
}

codes! {
    /// Why a set is rejected.
    RejectionCode {
        SegmentsDisagree = "segments_disagree":
            "Neighbouring segments disagree by more than half of the bias range.",
            "Do not use the set. Add rows where the segments overlap, or a soak in that range.";
        NoBetterThanNone = "no_better_than_none":
            "On an axis, the bias stability or the RMS error with compensation is not below the one without.",
            "Do not use the set. Check that log and unit belong together, then calibrate again.";
        FullScale = "full_scale":
            "An axis is at its largest or smallest value again and again.",
            "Leave the stretch out with `--exclude`, or calibrate with a wider range or less motion.";
        IdenticalValues = "identical_values":
            "An axis repeats a value, bit by bit, for much longer than it usually does.",
            "Leave the stretch out with `--exclude`, or the axis. Look for a cut connection.";
        FrozenTemperature = "frozen_temperature":
            "The temperature stands still, bit by bit, although the temperature of the unit does not.",
            "Leave the stretch out with `--exclude`, or check the sensor and calibrate again.";
        RunningTotal = "running_total":
            "An axis is a running total.",
            "Log the difference from row to row, and fit again.";
        TemperatureJump = "temperature_jump":
            "The temperature changes faster than a unit can.",
            "Check how the sensor's value is converted: width of the integer, sign, unit.";
        AlternatingSources = "alternating_sources":
            "Rows of several sources take turns.",
            "Write a log for each source, and fit each alone.";
        DisturbedShare = "disturbed_share":
            "An axis is far from what temperature explains in more of a log than may be left out.",
            "Do not use the set. Leave the times out with `--exclude`, or record the log again with the unit at rest.";
        LargeBiasStep = "large_bias_step":
            "The bias of an axis steps by more than that of a unit at rest can.",
            "Do not use the set. Leave the times out with `--exclude`, or record the log again with the unit at rest.";
        ManyBiasSteps = "many_bias_steps":
            "The bias of an axis steps four times or more in a log.",
            "Do not use the set. If it steps at one temperature, the model cannot follow it; else look for a loose contact.";
        ThinRun = "thin_run":
            "The logs cover fewer than 15 degC, or hold fewer than 20 means of 10 s.",
            "Do not use the set. Record a longer run over a wider range, up and down.";
        TrendWithTemperature = "trend_with_temperature":
            "On a log, the residual has a correlation with the temperature beyond 0.5 that is not by chance.",
            "Do not use the set. Check the sensor and the formula of its temperature, then calibrate again.";
        TrendWithRate = "trend_with_rate":
            "On a log, the residual has a correlation with the rate of temperature beyond 0.5 that is not by chance.",
            "Do not use the set. Fit with `--model auto`, or calibrate with more rates.";
        OutsideCalibratedRange = "outside_calibrated_range":
            "20 % or more of the rows of a log lie outside the calibrated temperatures or rates.",
            "The log says little of the set. Calibrate over a wider range, or verify within it.";
        TooManyBadRows = "too_many_bad_rows":
            "More than 5 % of the rows of a log were left out as bad.",
            "Mend the recording. If the reason is one column, name another one.";
        HeldOutWorse = "held_out_worse":
            "On soaks and ramps left out of the fit, an axis is worse than a constant by 25 % or more, and by more than one standard error.",
            "Do not use the set. Fit with `--model auto`, or calibrate again.";
    }
}

codes! {
    /// What should be known of a set before it is used.
    WarningCode {
        ExcludedRows = "excluded_rows":
            "Rows lie in a stretch that `--exclude` leaves out.",
            "Check that the right stretch was left out.";
        Spikes = "spikes":
            "Rows were left out as spikes.",
            "A few are normal. If there are many, look for a loose cable.";
        DisturbedRows = "disturbed_rows":
            "Rows were left out as disturbed for 10 s or more.",
            "Look for somebody at the door or a loose cable at these times.";
        UnusableRows = "unusable_rows":
            "Rows were not fitted, since the core did not accept their temperature or interval.",
            "A few are normal. If there are many, check the sensor and the recording.";
        RowsOutsideSegments = "rows_outside_segments":
            "Rows lie outside the given segments.",
            "At run time the temperature is clamped there. Extend the segments or shorten the run.";
        BiasStep = "bias_step":
            "The bias of an axis steps.",
            "Look at the log there. If the step is not of the unit, leave the stretch out with `--exclude`.";
        TermsDropped = "terms_dropped":
            "A segment lacks terms that its rows cannot separate from the others.",
            "Calibrate with a second rate in that range, or accept fewer terms.";
        NoRateTerms = "no_rate_terms":
            "The chosen model has no rate terms.",
            "If the unit depends on the rate, calibrate with several rates, up and down.";
        RateTermsDropped = "rate_terms_dropped":
            "An axis has no rate terms.",
            "If the axis depends on the rate, calibrate with several rates, up and down.";
        HistoryTermsDropped = "history_terms_dropped":
            "An axis has no history terms, others have.",
            "If the axis has hysteresis, calibrate with more rates and turning points.";
        HistoryTermsNotTried = "history_terms_not_tried":
            "All ramps are of one rate, so hysteresis and lags look the same.",
            "Calibrate with a second rate, if the unit has hysteresis or warms up slowly.";
        SensorLags = "sensor_lags":
            "The temperature follows the source of the bias, so the model has to predict it.",
            "Place the sensor nearer to the source, such as on the coil or the block of the gyro.";
        HeldOutNoBetter = "held_out_no_better":
            "On soaks and ramps left out of the fit, an axis is not better than without compensation.",
            "Do not use the set before a verification log accepts it.";
        SimplerModelBetter = "simpler_model_better":
            "On soaks and ramps left out of the fit, another model does better by 5 % or more, by more than one standard error, and by 1 % of the error without compensation.",
            "Fit the model that is named, or calibrate with more soaks and ramps.";
        ThinSegment = "thin_segment":
            "The fitted rows span less than 80 % of a segment.",
            "Make the segment narrower or the run wider.";
        IllConditioned = "ill_conditioned":
            "The condition number of a segment is above 100.",
            "The coefficients are hardly determined. Make the segment wider, or add rates in that range.";
        BoundaryMoved = "boundary_moved":
            "A boundary between segments was moved by more than 0.01 degC to the grid of the table.",
            "Choose boundaries on a common grid, such as 5 degC.";
        Rounding = "rounding":
            "Rounding in f32 can exceed 1 % of the bias stability with compensation.",
            "State the bound of the rounding in the sign-off.";
        ResidualFollowsTemperature = "residual_follows_temperature":
            "The residual has a correlation with the temperature beyond chance.",
            "Fit with `--model auto` or more segments. If that does not help, calibrate again.";
        ResidualFollowsRate = "residual_follows_rate":
            "The residual has a correlation with the rate of temperature beyond chance.",
            "Fit with `--model auto`. If that does not help, calibrate with more rates.";
        ReferenceBetter = "reference_better":
            "The reference of the evaluation does better than the set.",
            "Use the reference, or calibrate again.";
        FlaggedRows = "flagged_rows":
            "5 % or more of the rows lie outside the calibrated range, or more than 1 % have another flag than `settling`.",
            "The log leaves the calibrated range, or its temperature is not accepted. Check which, then calibrate over a wider range.";
        StandingTemperature = "standing_temperature":
            "The temperature stands still, bit by bit, and it is not clear whether the unit's does.",
            "Check the sensor. If it hung, leave the stretch out with `--exclude`.";
        Fahrenheit = "fahrenheit":
            "The temperatures look like degrees Fahrenheit.",
            "If they are, convert them to degC and fit again.";
        OwnCorrection = "own_correction":
            "The logger's own temperature correction may be in the values.",
            "If it was on, switch it off, record again and fit that log.";
        TimeRestarts = "time_restarts":
            "The recorder started again. Its runs are set an hour apart, since nobody knows the pause.",
            "Check that this is so. If the pause was short, the rates after it are wrong: cut the file, and fit the runs as logs of their own.";
        LongBursts = "long_bursts":
            "Rows are stamped in bursts more than 10 s apart, so the time of each row is a guess.",
            "Record a time for each row.";
        FewMeans = "few_means":
            "The logs hold fewer than 60 means of 10 s.",
            "Record a longer run.";
        OneDirection = "one_direction":
            "The logs only heat the unit, or only cool it.",
            "Calibrate up and down, or lag and hysteresis cannot be seen.";
        FastTemperature = "fast_temperature":
            "The temperature changes faster than the core follows.",
            "Heat and cool more slowly. If the unit changes so fast in use, raise `--max-slew`.";
        ResidualAboveNoise = "residual_above_noise":
            "What the model leaves of an axis is far above the noise of its rows.",
            "Look for a wrong temperature, vibration or motion. Fit with `--model auto`, which knows more lags.";
        ConstantAlone = "constant_alone":
            "On soaks and ramps left out of the fit, the terms of an axis are not better than a constant. It keeps the constant alone.",
            "If the axis depends on the temperature, calibrate over a wider range, or look for what disturbs it.";
    }
}

/// One reason to reject a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rejection {
    /// Its kind.
    pub code: RejectionCode,
    /// The axis, if it is of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// What was found, for a person.
    pub message: String,
}

/// One thing to know of a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Warning {
    /// Its kind.
    pub code: WarningCode,
    /// The axis, if it is of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// What was found, for a person.
    pub message: String,
}

impl Rejection {
    /// Of no axis alone.
    pub fn new(code: RejectionCode, message: String) -> Self {
        Self {
            code,
            axis: None,
            message,
        }
    }

    /// Of one axis; the message begins with its name.
    pub fn of_axis(code: RejectionCode, axis: &str, found: impl std::fmt::Display) -> Self {
        Self {
            code,
            axis: Some(axis.to_owned()),
            message: format!("axis {axis}: {found}"),
        }
    }
}

impl Warning {
    /// Of no axis alone.
    pub fn new(code: WarningCode, message: String) -> Self {
        Self {
            code,
            axis: None,
            message,
        }
    }

    /// Of one axis; the message begins with its name.
    pub fn of_axis(code: WarningCode, axis: &str, found: impl std::fmt::Display) -> Self {
        Self {
            code,
            axis: Some(axis.to_owned()),
            message: format!("axis {axis}: {found}"),
        }
    }
}

/// A verdict with its reasons. As JSON: `verdict`, `verified`, `rejections`, `warnings`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Judgement {
    /// Why the set is rejected; empty if it is not.
    pub rejections: Vec<Rejection>,
    /// What should be known before it is used.
    pub warnings: Vec<Warning>,
    /// Whether the set has done better than none on a log that it was not fitted to.
    pub verified: bool,
}

impl Judgement {
    /// What follows from rejections and warnings.
    pub const fn verdict(&self) -> Verdict {
        match (self.rejections.is_empty(), self.warnings.is_empty()) {
            (false, _) => Verdict::Rejected,
            (true, false) => Verdict::AcceptedWithWarnings,
            (true, true) => Verdict::Accepted,
        }
    }

    /// Whether the set is not rejected.
    pub const fn is_accepted(&self) -> bool {
        self.rejections.is_empty()
    }
}

/// Something with the judgement that follows, as one JSON object.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Judged<'a, T> {
    /// An object.
    #[serde(flatten)]
    pub of: T,
    /// What follows.
    #[serde(flatten)]
    pub judgement: &'a Judgement,
}

impl Serialize for Judgement {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Judgement", 4)?;
        object.serialize_field("verdict", &self.verdict())?;
        object.serialize_field("verified", &self.verified)?;
        object.serialize_field("rejections", &self.rejections)?;
        object.serialize_field("warnings", &self.warnings)?;
        object.end()
    }
}
