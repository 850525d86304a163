//! Where the compiler put the private fields of the core's types.
//!
//! On the host, by turning each byte of a value over and reading in its `Debug` output which field
//! that was; then the bytes of the same constants in the target's code are compared field by field.

#![allow(unsafe_code, reason = "looks into values byte by byte")]

use std::fmt::Debug;
use std::mem::MaybeUninit;

use anyhow::{Context, Result, bail, ensure};
use tempco::{BiasRamp, PulseRamp, RampBuffer, Status};
use tempco::{Interval, Play, SecondLag, Table, Terms, Thermal, ThermalSettings, ThermalState};

use crate::smt::{Field, FieldType, Object};

/// The objects that the shims' pointers point to.
pub(crate) fn objects(ir: &str) -> Result<Vec<Object>> {
    let thermal = Thermal::new(ThermalSettings::DEFAULT)?;
    let object = |name: &str, fields: Vec<Field>, readable| Object {
        name: name.to_owned(),
        fields,
        readable,
    };
    let single = |name: &str, ty| {
        let field = Field {
            name: "value".to_owned(),
            offset: 0,
            ty,
        };
        object(name, vec![field], false)
    };
    let state = checked(&ThermalState::new(&thermal), ir, "PROVE_STATE")?;
    let interval = checked(&Interval::new(&thermal, 0.25), ir, "PROVE_INTERVAL")?;
    let play = checked(&Play::new(25.0), ir, "PROVE_PLAY")?;
    let lag = checked(&SecondLag::new(25.0), ir, "PROVE_LAG")?;
    let thermal = checked(&thermal, ir, "PROVE_THERMAL")?;
    let terms = (0..Terms::COUNT).map(|number| Field {
        name: Terms::NAMES[number].to_owned(),
        offset: 4 * number,
        ty: FieldType::Float,
    });
    let mut objects = sample_half(ir)?;
    objects.extend([
        object("state", state, true),
        object("interval", interval, true),
        object("thermal", thermal, true),
        object("table", table(ir)?, true),
        object("terms", terms.collect(), true),
        object("play", play, true),
        object("lag", lag, true),
        single("effective_c", FieldType::Float),
        single("rate_c_per_min", FieldType::Float),
        single("lag2_c", FieldType::Float),
        single("play1_c", FieldType::Float),
        single("play2_c", FieldType::Float),
        single("z", FieldType::Float),
        single("cell", FieldType::Int(32)),
        single("status", FieldType::Int(16)),
    ]);
    Ok(objects)
}

/// Ramps, their buffer and correctors.
fn sample_half(ir: &str) -> Result<Vec<Object>> {
    let object = |name: &str, fields: Vec<Field>, readable| Object {
        name: name.to_owned(),
        fields,
        readable,
    };
    // As many numbers, one after the other.
    let numbers = |count: usize, ty: FieldType| -> Vec<Field> {
        let field = |number: usize| Field {
            name: number.to_string(),
            offset: 4 * number,
            ty,
        };
        (0..count).map(field).collect()
    };
    let ramp = BiasRamp {
        end: [1.5, 2.5, 3.5],
        slope: [4.5, 5.5, 6.5],
        samples: 0x1234,
        status: Status::from_bits(0x5678),
    };
    let fixed = PulseRamp {
        end: [0x1122_3344, 0x2233_4455, 0x3344_5566],
        slope: [0x4455_6677, 0x5566_7788, 0x6677_8899],
        samples: 0x1234,
        status: Status::from_bits(0x5678),
    };
    // Words of 0, but for the flag of the start; so it is the host's order that is taken.
    let ramps = checked(&RampBuffer::<3>::new(), ir, "PROVE_RAMPS")?;
    let pulse_ramps = checked(&RampBuffer::<3, i32>::new(), ir, "PROVE_PULSE_RAMPS")?;
    ensure!(ramps == pulse_ramps, "buffers differ");
    Ok(vec![
        object("ramps", ramps, true),
        object("ramp", checked(&ramp, ir, "PROVE_RAMP")?, true),
        object("fixed", checked(&fixed, ir, "PROVE_PULSE_RAMP")?, false),
        object("corrector", corrector(ir)?, true),
        object("raw", numbers(3, FieldType::Float), true),
        object("per_unit", numbers(3, FieldType::Float), true),
        object("block", numbers(24, FieldType::Float), true),
        object("pulses", numbers(3, FieldType::Int(32)), true),
        object("bias", numbers(3, FieldType::Float), false),
        object("out", numbers(3, FieldType::Float), false),
        object("rest", numbers(3, FieldType::Int(32)), false),
    ])
}

/// The corrector of pulses: a pointer, and what it carries, half a pulse at the start.
fn corrector(ir: &str) -> Result<Vec<Field>> {
    let bytes = bytes_of_constant(ir, "PROVE_PULSES")?;
    let carried = (1_u32 << 25).to_le_bytes();
    let is_carried: Vec<bool> = bytes.chunks(4).map(|word| *word == carried).collect();
    ensure!(
        is_carried == [false, true, true, true],
        "the corrector of pulses is laid out in another way"
    );
    let mut fields = vec![Field {
        name: "ramps".to_owned(),
        offset: 0,
        ty: FieldType::Pointer("ramps"),
    }];
    fields.extend((0..3).map(|axis| Field {
        name: format!("carried.{axis}"),
        offset: 4 + 4 * axis,
        ty: FieldType::Int(32),
    }));
    Ok(fields)
}

/// The fields of a type that holds nothing but numbers and truth values.
fn fields<T: Debug>() -> Result<Vec<Field>> {
    let size = size_of::<T>();
    let show = |byte: Option<usize>| -> Vec<(String, String)> {
        let mut value = MaybeUninit::<T>::zeroed();
        if let Some(byte) = byte {
            // SAFETY: `byte` is less than the size of `T`.
            unsafe { *value.as_mut_ptr().cast::<u8>().add(byte) = 1 };
        }
        // SAFETY: the types this is called for consist of f32, integers and bool; all of them may
        // hold bytes of 0 and 1.
        leaves(&format!("{:#?}", unsafe { value.assume_init() }))
    };
    let plain = show(None);
    let mut found: Vec<Field> = Vec::new();
    for byte in 0..size {
        let turned = show(Some(byte));
        let different = plain.iter().zip(&turned).find(|(a, b)| a != b);
        let Some(((name, value), _)) = different else {
            continue;
        };
        match found.iter_mut().find(|field| field.name == *name) {
            None => found.push(Field {
                name: name.clone(),
                offset: byte,
                ty: match value.as_str() {
                    "false" => FieldType::Bool,
                    "0" => FieldType::Int(8),
                    _ => FieldType::Float,
                },
            }),
            Some(field) => match &mut field.ty {
                FieldType::Int(bits) if field.offset + *bits as usize / 8 == byte => *bits += 8,
                FieldType::Float if byte < field.offset + 4 => {}
                _ => bail!("two fields are called {name}"),
            },
        }
    }
    ensure!(found.len() == plain.len(), "fields were not all found");
    Ok(found)
}

/// The names of the numbers in a `{:#?}` output, with those they lie in, and their values; the
/// name of an array's element is its number.
fn leaves(text: &str) -> Vec<(String, String)> {
    // Of each that is open the name, and in an array the number of the next element.
    let mut open: Vec<(String, Option<usize>)> = Vec::new();
    let mut leaves = Vec::new();
    for line in text.lines().map(|line| line.trim().trim_end_matches(',')) {
        if matches!(line, "}" | ")" | "]") {
            open.pop();
            continue;
        }
        let (name, rest) = line.split_once(": ").unwrap_or(("", line));
        let name = match open.last_mut() {
            Some((_, Some(number))) => std::mem::replace(number, *number + 1).to_string(),
            _ => name.to_owned(),
        };
        if rest.ends_with(['{', '(', '[']) {
            open.push((name, rest.ends_with('[').then_some(0)));
        } else if rest != "[]" && !rest.starts_with("PhantomData") {
            let path = open.iter().map(|(name, _)| name.as_str()).chain([&*name]);
            let path: Vec<&str> = path.filter(|name| !name.is_empty()).collect();
            leaves.push((path.join("."), rest.to_owned()));
        }
    }
    leaves
}

/// The fields, after a look whether the target holds the constant in the same places.
fn checked<T: Debug>(value: &T, ir: &str, constant: &str) -> Result<Vec<Field>> {
    let fields = fields::<T>()?;
    let target = bytes_of_constant(ir, constant)?;
    // SAFETY: the bytes of fields, which alone are read below, are initialised, and nothing
    // changes them meanwhile.
    let host = unsafe {
        std::slice::from_raw_parts(std::ptr::from_ref(value).cast::<u8>(), size_of::<T>())
    };
    for field in &fields {
        let bytes = field.ty.in_memory().bytes().unwrap_or_default();
        let range = field.offset..field.offset + bytes;
        let same = target.get(range.clone()) == host.get(range);
        ensure!(
            same,
            "{constant}.{} lies elsewhere on the target",
            field.name
        );
    }
    Ok(fields)
}

/// The numbers of the table, which are all different, by their bits.
fn table(ir: &str) -> Result<Vec<Field>> {
    let thermal = Thermal::new(ThermalSettings::DEFAULT)?;
    let cells = [[Terms::new([], [])]; 3];
    let table = Table::new(thermal, 3.0, 11.0, &cells)?.calibrated(4.25, 9.75)?;
    let bytes = bytes_of_constant(ir, "PROVE_TABLE")?;
    let shown = leaves(&format!("{table:#?}"));
    ["first_edge_c", "cells_per_c", "t_min_c", "t_max_c"]
        .into_iter()
        .map(|name| {
            let value = shown.iter().find(|(field, _)| field == name);
            let value: f32 = value.context("a field of the table is gone")?.1.parse()?;
            let pattern = value.to_le_bytes();
            let places: Vec<usize> = (0..bytes.len() / 4)
                .map(|word| 4 * word)
                .filter(|&at| bytes[at..at + 4] == pattern)
                .collect();
            match places[..] {
                [offset] => Ok(Field {
                    name: name.to_owned(),
                    offset,
                    ty: FieldType::Float,
                }),
                _ => bail!("{name} is not to be found in the table's bytes"),
            }
        })
        .collect()
}

/// The bytes of a constant in the code; those of a pointer or undefined ones are 0.
fn bytes_of_constant(ir: &str, name: &str) -> Result<Vec<u8>> {
    let start = format!("@{name} = ");
    let line = ir.lines().find(|line| line.starts_with(&start));
    let mut rest = line.with_context(|| format!("the code has no constant {name}"))?;
    let values = [" constant ", " global "].map(|kind| rest.rsplit_once(kind));
    rest = values.into_iter().flatten().next().context("a constant")?.1;
    // In a packed structure the types come first.
    if let Some((_, values)) = rest.split_once("}> <{ ") {
        rest = values;
    }
    let mut bytes = Vec::new();
    loop {
        let length = if let Some(array) = rest.strip_prefix('[') {
            let (count, tail) = array.split_once(" x i8] ").context("an array of bytes")?;
            rest = tail;
            count.parse::<usize>()?
        } else {
            ensure!(rest.starts_with("ptr @"), "a constant of `{rest}`");
            4
        };
        if let Some(text) = rest.strip_prefix("c\"") {
            let (text, tail) = text.split_once('"').context("an open string")?;
            let before = bytes.len();
            let mut chars = text.bytes();
            while let Some(byte) = chars.next() {
                bytes.push(if byte == b'\\' {
                    let digits = [chars.next().unwrap_or(0), chars.next().unwrap_or(0)];
                    u8::from_str_radix(std::str::from_utf8(&digits)?, 16)?
                } else {
                    byte
                });
            }
            ensure!(bytes.len() - before == length, "length of a constant");
            rest = tail;
        } else {
            bytes.resize(bytes.len() + length, 0);
            rest = &rest[rest.find(", ").unwrap_or(rest.len())..];
        }
        match rest.strip_prefix(", ") {
            Some(more) if more.starts_with(['[', 'p']) => rest = more,
            _ => return Ok(bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_name() {
        let fields = fields::<Interval>().unwrap();
        let find = |name: &str| fields.iter().find(|field| field.name == name).unwrap();
        assert_eq!(find("ticks").ty, FieldType::Int(32));
        assert_eq!(find("alpha").ty, FieldType::Float);
        assert_eq!(find("near").ty, FieldType::Int(32));
        assert_eq!(find("status").ty, FieldType::Int(16));
    }

    #[test]
    fn elements_of_arrays_are_numbered() {
        let fields = fields::<ThermalState>().unwrap();
        let contact = |number: usize| {
            let name = format!("plays.plays.{number}.contact_c");
            fields.iter().find(|field| field.name == name).unwrap()
        };
        assert_eq!(contact(0).offset + 4, contact(1).offset);
    }

    #[test]
    fn constants_are_read_as_bytes() {
        let ir = "@A = dso_local constant <{ ptr, [3 x i8], [1 x i8] }> <{ ptr @x, \
                  [3 x i8] c\"a\\FF\\00\", [1 x i8] undef }>, align 4";
        assert_eq!(
            bytes_of_constant(ir, "A").unwrap(),
            [0, 0, 0, 0, b'a', 0xFF, 0, 0]
        );
    }
}
