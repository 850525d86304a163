//! What the compensation is compared with, beside none.

use std::borrow::Cow;

use tempco_set::CoefficientSet;

/// What the compensation is compared with.
pub(super) struct Reference<'a> {
    /// What it is.
    pub(super) name: String,
    /// The set that is run along, if there is one.
    pub(super) set: Option<Cow<'a, CoefficientSet>>,
}

impl<'a> Reference<'a> {
    /// `against`, or else the static part of `set`.
    pub(super) fn new(set: &CoefficientSet, against: Option<&'a CoefficientSet>) -> Self {
        if let Some(other) = against {
            return Self {
                name: format!(
                    "the set of unit {} with table CRC {}",
                    other.serial, other.table_crc32
                ),
                set: Some(Cow::Borrowed(other)),
            };
        }
        let set = set.static_part().map(Cow::Owned);
        let name = match set {
            Some(_) => "the static part of the set",
            None => "none: the set makes no use of the rate",
        };
        Self {
            name: name.to_owned(),
            set,
        }
    }
}
