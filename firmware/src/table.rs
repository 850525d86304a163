//! The coefficient table built into the image: `TEMPCO_TABLE` at build time, or the example.
//!
//! [`TABLES`] holds one [`tempco::Table`] per temperature channel. They are checked by the
//! compiler: an image with a bad table cannot be built.
// The file is written by a program, and describes itself.
#![allow(missing_docs, clippy::all)]

include!(env!("TEMPCO_TABLE_RS"));
