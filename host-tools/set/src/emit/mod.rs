//! What is emitted from a set: its table as Rust, as C and as a flash image, and the way back from
//! the image.

mod from_image;
pub(crate) mod table_bin;
pub(crate) mod table_h;
pub(crate) mod table_rs;

pub use from_image::{axis_unit, set_of_image};
pub use table_bin::table_bin;
pub use table_h::table_h;
pub use table_rs::table_rs;
