//! Error codes.

use core::ffi::CStr;

use tempco::TableError;
use tempco_image::ImageError;

macro_rules! errors {
    ($($(#[doc = $doc:literal])+ $name:ident = $code:literal, $text:literal;)+) => {
        /// Why a call was refused. The codes stand in `tempco.h`, as `TEMPCO_E_` with these names.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(i32)]
        pub enum Error {
            $($(#[doc = $doc])+ $name = $code,)+
        }

        impl Error {
            /// Every error with its name.
            pub const ALL: &'static [(Self, &'static str)] =
                &[$((Self::$name, stringify!($name))),+];

            /// The error in words.
            pub const fn message(self) -> &'static CStr {
                match self {
                    $(Self::$name => $text,)+
                }
            }
        }
    };
}

errors! {
    /// A pointer is null.
    Null = -1, c"a pointer is null";
    /// A pointer has not the alignment of what it points to.
    Alignment = -2, c"an object or an image is not aligned";
    /// The bytes end within the image.
    Short = -3, c"the bytes end within the image";
    /// The bytes are no image.
    Magic = -4, c"not a table image";
    /// The image has a layout or equations of another major version.
    Version = -5, c"an image of another version: write it again from coefficients.json";
    /// A CRC of the image is wrong.
    Crc = -6, c"a CRC of the image is wrong: it was damaged";
    /// A field of the image is out of range, or fields do not agree.
    Field = -7, c"a field of the image is out of range or does not agree";
    /// There is no such channel, or it has another number of axes.
    Shape = -8, c"no such channel, or another number of axes";
    /// A setting, an edge or a gain is not finite or out of range.
    Setting = -9, c"a setting of the table is not finite or out of range";
    /// There are no cells, or too many.
    Cells = -10, c"no cells, or too many";
    /// A coefficient is not finite or beyond 1e20.
    Coefficient = -11, c"a coefficient is not finite or beyond 1e20";
    /// A number of an axis is not finite or below zero.
    Axis = -12, c"a number of an axis is not finite or below zero";
    /// The bias jumps between two cells of an image marked as continuous.
    Jump = -13, c"the bias jumps between cells of an image marked as continuous";
    /// Refused for another reason.
    Other = -99, c"refused";
}

impl From<TableError> for Error {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Setting(_) => Self::Setting,
            TableError::CellCount => Self::Cells,
            TableError::Coefficient { .. } => Self::Coefficient,
            _ => Self::Other,
        }
    }
}

impl From<ImageError> for Error {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::Short { .. } => Self::Short,
            ImageError::Magic => Self::Magic,
            ImageError::Format { .. } | ImageError::Model { .. } => Self::Version,
            ImageError::Header | ImageError::Crc { .. } => Self::Crc,
            ImageError::Field(_) => Self::Field,
            ImageError::Shape => Self::Shape,
            ImageError::TooLarge { .. } => Self::Cells,
            ImageError::Table { error, .. } => error.into(),
            ImageError::Axis { .. } => Self::Axis,
            ImageError::Jump { .. } => Self::Jump,
            ImageError::Alignment => Self::Alignment,
            _ => Self::Other,
        }
    }
}

/// What C gets: 0 or the code.
pub(crate) fn code(result: Result<(), Error>) -> i32 {
    match result {
        Ok(()) => 0,
        Err(error) => error as i32,
    }
}
