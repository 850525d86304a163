//! The worked example of `docs/flash-image.md` is the image that this crate writes.

mod common;

use std::fmt::Write;

fn hex_dump(bytes: &[u8]) -> String {
    let mut dump = String::new();
    for (line, chunk) in bytes.chunks(16).enumerate() {
        write!(dump, "{:04x} ", 16 * line).unwrap();
        for word in chunk.chunks(4) {
            dump.push(' ');
            word.iter()
                .for_each(|byte| write!(dump, "{byte:02x}").unwrap());
        }
        dump.push('\n');
    }
    dump
}

#[test]
fn the_documented_dump_is_what_is_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/flash-image.md");
    let document = std::fs::read_to_string(path).unwrap();
    let (bytes, len) = common::example();
    let dump = hex_dump(&bytes.0[..len]);
    assert!(document.contains(&dump), "the example should be\n{dump}");

    let [_, (bytes, len)] = common::examples();
    let dump = hex_dump(&bytes.0[..len]);
    let lines: Vec<&str> = dump.lines().collect();
    let end = lines[lines.len() - 2..].join("\n");
    assert!(document.contains(&end), "the signature should be\n{end}");
}
