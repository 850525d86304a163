//! Cycles of straight Thumb code on a Cortex-M4, estimated from its instructions.
//!
//! | instruction | cycles |
//! | --- | --- |
//! | LDR, STR, VLDR, VSTR of one register (never taken as pipelined) | 2 |
//! | PUSH, POP, LDM, STM, LDRD, STRD, VLDM, VSTM of N registers | 1 + N |
//! | VMLA and its kin | 3 |
//! | SDIV, UDIV (the longest) | 12 |
//! | VDIV, VSQRT | 14 |
//! | BX, and loading the program counter on top | 3 |
//! | everything else, an instruction skipped after IT too | 1 |
//! | an FP result used by the very next instruction, on top | 1 |
//!
//! Flash wait states are not in it: it is an estimate to compare code by, not a measurement.

use anyhow::{Context, Result, bail};

/// What straight code executes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Price {
    pub(crate) instructions: u32,
    pub(crate) cycles: u32,
}

/// One instruction.
struct Instruction {
    cycles: u32,
    /// The FP register it computes.
    result: Option<u16>,
    /// The FP registers it uses.
    uses: [Option<u16>; 3],
    returns: bool,
}

impl Instruction {
    fn plain(cycles: u32) -> Self {
        Self {
            cycles,
            result: None,
            uses: [None; 3],
            returns: false,
        }
    }

    /// Several registers, the last of which may be the program counter.
    fn block(registers: u16, returns: bool) -> Self {
        let branch = if returns { 3 } else { 0 };
        Self {
            returns,
            ..Self::plain(1 + registers.count_ones() + branch)
        }
    }
}

/// Prices a function from its first instruction to its return.
///
/// # Errors
/// The code branches or does not return.
pub(crate) fn price(code: &[u8]) -> Result<Price> {
    let mut halves = code
        .chunks_exact(2)
        .map(|half| u16::from_le_bytes([half[0], half[1]]));
    let mut price = Price::default();
    let mut before = None;
    loop {
        let first = halves.next().context("the code does not return")?;
        let instruction = if first >> 11 < 0b11101 {
            narrow(first)?
        } else {
            wide(first, halves.next().context("the code is cut off")?)?
        };
        let waits = before.is_some() && instruction.uses.contains(&before);
        price.instructions += 1;
        price.cycles += instruction.cycles + u32::from(waits);
        before = instruction.result;
        if instruction.returns {
            return Ok(price);
        }
    }
}

/// An instruction of 16 bits.
fn narrow(code: u16) -> Result<Instruction> {
    Ok(match code >> 8 {
        0x47 if code & 0x80 == 0 => Instruction {
            returns: true,
            ..Instruction::plain(3)
        },
        0x48..=0x9f => Instruction::plain(2),
        0xb4 | 0xb5 => Instruction::block(code & 0x1ff, false),
        0xbc | 0xbd => Instruction::block(code & 0x1ff, code & 0x100 != 0),
        0xc0..=0xcf => Instruction::block(code & 0xff, false),
        0x47 | 0xb1 | 0xb3 | 0xb9 | 0xbb | 0xd0..=0xe7 => bail!("{code:04x} branches"),
        _ => Instruction::plain(1),
    })
}

/// An instruction of 32 bits.
fn wide(first: u16, second: u16) -> Result<Instruction> {
    Ok(match first {
        _ if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 => bail!("a table branch"),
        _ if first & 0xfe40 == 0xe800 => {
            Instruction::block(second, first & 0x10 != 0 && second & 0x8000 != 0)
        }
        _ if first & 0xfe00 == 0xe800 => Instruction::plain(3),
        _ if first & 0xfe00 == 0xf800 => {
            let returns = first & 0x10 != 0 && second >> 12 == 15;
            Instruction {
                returns,
                ..Instruction::plain(if returns { 5 } else { 2 })
            }
        }
        _ if first & 0xffd0 == 0xfb90 => Instruction::plain(12),
        _ if first & 0xfe00 == 0xec00 => fp_transfer(first, second),
        _ if first & 0xff00 == 0xee00 => fp_operation(first, second),
        // MSR, MRS and barriers lie among the branches.
        _ if first & 0xf800 == 0xf000 && second & 0x8000 != 0 && first & 0xff80 != 0xf380 => {
            bail!("{first:04x} {second:04x} branches")
        }
        _ => Instruction::plain(1),
    })
}

/// The number of an FP register, of which `low` is the place of the lowest bit.
fn register(high: u16, low: u16) -> Option<u16> {
    Some((high & 15) << 1 | low & 1)
}

fn fp_transfer(first: u16, second: u16) -> Instruction {
    let double = second & 0x100 != 0;
    let data = register(second >> 12, first >> 6);
    if first & 0x0fe0 == 0x0c40 {
        return Instruction::plain(2);
    }
    let one_register = first & 0x120 == 0x100;
    let store = first & 0x10 == 0;
    Instruction {
        uses: [data.filter(|_| store), None, None],
        ..Instruction::plain(match (one_register, double) {
            (true, false) => 2,
            (true, true) => 3,
            (false, _) => 1 + u32::from(second & 0xff),
        })
    }
}

fn fp_operation(first: u16, second: u16) -> Instruction {
    let d = register(second >> 12, first >> 6);
    let n = register(first, second >> 7);
    let m = register(second, second >> 5);
    if second & 0x10 != 0 {
        // VMOV from or to a core register, VMRS.
        let from_fp = first & 0x10 != 0 && first & 0xe0 == 0;
        return Instruction {
            uses: [n.filter(|_| from_fp), None, None],
            ..Instruction::plain(1)
        };
    }
    let (cycles, result, uses) = match (first & 0xb0, first & 0xf, second & 0xc0) {
        (0x20 | 0x30, ..) => (1, d, [n, m, None]),
        (0x80, ..) => (14, d, [n, m, None]),
        (0x00 | 0x10 | 0x90 | 0xa0, ..) => (3, d, [n, m, d]),
        (_, 1, 0xc0) => (14, d, [m, None, None]),
        (_, 4, _) => (1, None, [d, m, None]),
        (_, 5, _) => (1, None, [d, None, None]),
        (_, _, 0x00 | 0x80) => (1, d, [None; 3]),
        _ => (1, d, [m, None, None]),
    };
    Instruction {
        result,
        uses,
        ..Instruction::plain(cycles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycles(halves: &[u16]) -> u32 {
        let mut code = halves.to_vec();
        code.push(0x4770); // bx lr
        let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        price(&bytes).unwrap().cycles - 3
    }

    #[test]
    fn each_rule_has_its_price() {
        for (expected, halves) in [
            (1, [0xbf58].as_slice()), // it pl
            (2, &[0x6b04]),           // ldr r4, [r0, #48]
            (2, &[0xf8c2, 0x8008]),   // str.w r8, [r2, #8]
            (3, &[0xe9d6, 0xa800]),   // ldrd sl, r8, [r6]
            (6, &[0xb5f0]),           // push {r4, r5, r6, r7, lr}
            (5, &[0xe92d, 0x0f00]),   // stmdb sp!, {r8, r9, sl, fp}
            (2, &[0xed96, 0x2a09]),   // vldr s4, [r6, #36]
            (3, &[0xed2d, 0x8b02]),   // vpush {d8}
            (1, &[0xee32, 0x0a40]),   // vsub.f32 s0, s4, s0
            (1, &[0xeef1, 0xfa10]),   // vmrs APSR_nzcv, fpscr
            (14, &[0xee80, 0x0a81]),  // vdiv.f32 s0, s1, s2
            (3, &[0xee00, 0x0a81]),   // vmla.f32 s0, s1, s2
            (1, &[0xea23, 0x030c]),   // bic.w r3, r3, ip
            (12, &[0xfb90, 0xf0f1]),  // sdiv r0, r0, r1
        ] {
            assert_eq!(cycles(halves), expected, "{halves:04x?}");
        }
    }

    #[test]
    fn a_result_used_at_once_costs_one_more() {
        let (sub, moved, other) = ([0xee32, 0x0a40], [0xee10, 0x1a10], [0xee11, 0x1a10]);
        assert_eq!(cycles(&[sub, moved].concat()), 3);
        assert_eq!(cycles(&[sub, other].concat()), 2);
        assert_eq!(cycles(&[&sub[..], &[0xbf00], &moved].concat()), 3);
    }

    #[test]
    fn code_that_branches_or_never_ends_is_refused() {
        assert!(price(&[0x00, 0xd0, 0x70, 0x47]).is_err());
        assert!(price(&[0x00, 0xbf]).is_err());
    }
}
