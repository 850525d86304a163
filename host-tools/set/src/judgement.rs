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

/// Codes that stay the same from version to version, each with its word.
macro_rules! codes {
    ($(#[$doc:meta])* $name:ident { $($(#[$of_code:meta])* $code:ident = $word:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$of_code])* #[serde(rename = $word)] $code,)+
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
        }
    };
}

codes! {
    /// Why a set is rejected.
    RejectionCode {
        /// Neighbouring segments disagree by more than half of the bias range
        /// ([`MISMATCH_ALARM`](crate::MISMATCH_ALARM)).
        SegmentsDisagree = "segments_disagree",
        /// The bias stability or the RMS error with compensation is not below the one without.
        NoBetterThanNone = "no_better_than_none",
    }
}

codes! {
    /// What should be known of a set before it is used.
    WarningCode {
        /// Rows in stretches that were excluded on request.
        ExcludedRows = "excluded_rows",
        /// Rows left out as spikes.
        Spikes = "spikes",
        /// Rows left out as disturbed for ten seconds or more.
        DisturbedRows = "disturbed_rows",
        /// Rows whose temperature or interval the core did not accept.
        UnusableRows = "unusable_rows",
        /// Rows at temperatures outside the given segments.
        RowsOutsideSegments = "rows_outside_segments",
        /// The bias of an axis steps.
        BiasStep = "bias_step",
        /// Terms of a segment were dropped, since the rows cannot separate them from the others.
        TermsDropped = "terms_dropped",
        /// The model has no rate terms, since they improve nothing.
        NoRateTerms = "no_rate_terms",
        /// An axis has no rate terms, since they do not improve it.
        RateTermsDropped = "rate_terms_dropped",
        /// An axis has no history terms, since they do not improve it.
        HistoryTermsDropped = "history_terms_dropped",
        /// All ramps are of one rate, from which no history term can be found.
        HistoryTermsNotTried = "history_terms_not_tried",
        /// On soaks and ramps left out of the fit, compensation does not help an axis.
        HeldOutNoBetter = "held_out_no_better",
        /// On soaks and ramps left out of the fit, a simpler model does better.
        SimplerModelBetter = "simpler_model_better",
        /// The fitted rows span little of a segment.
        ThinSegment = "thin_segment",
        /// The coefficients of a segment are hardly determined.
        IllConditioned = "ill_conditioned",
        /// Boundaries between segments were moved to the grid of the table.
        BoundaryMoved = "boundary_moved",
        /// Rounding in f32 is not small against the bias stability.
        Rounding = "rounding",
        /// What remains on the judged log follows the temperature.
        ResidualFollowsTemperature = "residual_follows_temperature",
        /// What remains on the judged log follows the rate of temperature.
        ResidualFollowsRate = "residual_follows_rate",
        /// On the judged log, the reference does better than the set.
        ReferenceBetter = "reference_better",
        /// Many rows of the judged log have a flag in their status.
        FlaggedRows = "flagged_rows",
    }
}

/// One reason to reject a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rejection {
    /// Its kind.
    pub code: RejectionCode,
    /// The axis, if it is of one.
    #[serde(skip_serializing_if = "Option::is_none")]
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
