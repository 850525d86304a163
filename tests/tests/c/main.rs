//! The core for C and C++: its archives, its header, and programs that use them.
#![cfg(unix)]

mod archive;
mod examples;
mod figures;
mod header;
mod hostile;
mod pages;
mod support;
