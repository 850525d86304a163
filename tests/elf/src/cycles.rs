//! Cycles of Thumb code on a Cortex-M4, estimated from the instructions that are executed.
//!
//! | instruction | cycles |
//! | --- | --- |
//! | LDR, STR, VLDR, VSTR of one register (never taken as pipelined) | 2 |
//! | PUSH, POP, LDM, STM, LDRD, STRD, VLDM, VSTM of N registers | 1 + N |
//! | VMLA and its kin | 3 |
//! | SDIV, UDIV (the longest) | 12 |
//! | VDIV, VSQRT | 14 |
//! | BX, and loading the program counter on top | 3 |
//! | a branch that was taken, on top (in code that was traced) | 2 |
//! | everything else, an instruction skipped after IT too | 1 |
//! | an FP result used by the very next instruction, on top | 1 |
//!
//! Flash wait states are not in it: it is an estimate to compare code by, not a measurement.

use capstone::Insn;
use capstone::arch::arm::{ArmInsn, ArmOperand, ArmOperandType, ArmReg};

use crate::decode::is;
use crate::{Error, Flow, Function, Instruction};

/// What a branch that is taken costs on top [cycles].
const TAKEN: u32 = 2;

/// What an instruction costs, and the FP registers by which the next one may have to wait.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Cost {
    cycles: u32,
    /// The FP register it computes.
    result: Option<u32>,
    /// The FP registers it uses.
    uses: Vec<u32>,
}

/// What code executes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Price {
    /// Instructions.
    pub instructions: u32,
    /// Cycles of a Cortex-M4.
    pub cycles: u32,
}

/// Prices instructions in the order in which they were executed.
pub fn price<'i>(executed: impl IntoIterator<Item = &'i Instruction>) -> Price {
    let mut price = Price::default();
    let mut before: Option<&Instruction> = None;
    for instruction in executed {
        let Cost { cycles, uses, .. } = &instruction.cost;
        price.instructions += 1;
        price.cycles += cycles;
        if let Some(before) = before {
            let waits = before
                .cost
                .result
                .is_some_and(|result| uses.contains(&result));
            let jumps = match before.flow {
                Flow::Jump(target) => target == instruction.address,
                Flow::Call(_) | Flow::Table | Flow::Indirect => true,
                Flow::Next | Flow::Return => false,
            };
            price.cycles += u32::from(waits) + if jumps { TAKEN } else { 0 };
        }
        before = Some(instruction);
    }
    price
}

impl Function {
    /// Prices the function from its first instruction to its return.
    ///
    /// # Errors
    /// The code branches or does not return.
    pub fn price(&self) -> Result<Price, Error> {
        let not_straight = |reason: &str| Error::NotStraight {
            function: self.name.clone(),
            reason: reason.to_owned(),
        };
        let mut executed = Vec::new();
        let mut instructions = self.instructions.iter();
        while let Some(instruction) = instructions.next() {
            executed.push(instruction);
            match instruction.flow {
                Flow::Next => {}
                Flow::Return => return Ok(price(executed)),
                // Over constants among the code.
                Flow::Jump(target) if !instruction.conditional && target > instruction.address => {
                    while instructions
                        .as_slice()
                        .first()
                        .is_some_and(|next| next.address < target)
                    {
                        instructions.next();
                    }
                }
                _ => return Err(not_straight(&format!("`{}` branches", instruction.text))),
            }
        }
        Err(not_straight("it does not return"))
    }
}

pub(crate) fn cost(insn: &Insn<'_>, operands: &[ArmOperand], flow: Flow) -> Cost {
    use ArmInsn::*;
    let accumulates = is(
        insn,
        &[
            ARM_INS_VMLA,
            ARM_INS_VMLS,
            ARM_INS_VNMLA,
            ARM_INS_VNMLS,
            ARM_INS_VFMA,
            ARM_INS_VFMS,
            ARM_INS_VFNMA,
            ARM_INS_VFNMS,
        ],
    );
    let stores = is(
        insn,
        &[ARM_INS_VSTR, ARM_INS_VSTMIA, ARM_INS_VSTMDB, ARM_INS_VPUSH],
    );
    let loads = is(
        insn,
        &[ARM_INS_VLDR, ARM_INS_VLDMIA, ARM_INS_VLDMDB, ARM_INS_VPOP],
    );
    let fp: Vec<u32> = operands.iter().flat_map(fp_registers).collect();
    let core = operands
        .iter()
        .filter(|operand| matches!(operand.op_type, ArmOperandType::Reg(_)))
        .filter(|operand| fp_registers(operand).is_empty())
        .count() as u32;

    let cycles = if is(insn, &[ARM_INS_BX]) {
        0
    } else if stores || loads {
        1 + fp.len() as u32
    } else if is(insn, &[ARM_INS_PUSH, ARM_INS_POP]) {
        1 + core
    } else if is(
        insn,
        &[ARM_INS_LDM, ARM_INS_LDMDB, ARM_INS_STM, ARM_INS_STMDB],
    ) {
        // One of them is the base.
        core
    } else if is(insn, &[ARM_INS_LDRD, ARM_INS_STRD]) {
        3
    } else if is(
        insn,
        &[
            ARM_INS_LDR,
            ARM_INS_LDRB,
            ARM_INS_LDRH,
            ARM_INS_LDRSB,
            ARM_INS_LDRSH,
            ARM_INS_STR,
            ARM_INS_STRB,
            ARM_INS_STRH,
        ],
    ) {
        2
    } else if accumulates {
        3
    } else if is(insn, &[ARM_INS_SDIV, ARM_INS_UDIV]) {
        12
    } else if is(insn, &[ARM_INS_VDIV, ARM_INS_VSQRT]) {
        14
    } else if is(insn, &[ARM_INS_VMOV]) && core == 2 {
        2
    } else {
        1
    };
    let branch = if flow == Flow::Return { 3 } else { 0 };

    let compares = is(insn, &[ARM_INS_VCMP, ARM_INS_VCMPE]);
    let moves_to_core = operands
        .first()
        .is_some_and(|operand| fp_registers(operand).is_empty());
    let (result, uses) = match fp.split_first() {
        _ if loads => (None, Vec::new()),
        _ if stores || compares || moves_to_core => (None, fp),
        // A move from core registers.
        _ if core > 0 => (None, Vec::new()),
        Some((result, _)) if accumulates => (Some(*result), fp),
        Some((result, uses)) => (Some(*result), uses.to_vec()),
        None => (None, fp),
    };
    Cost {
        cycles: cycles + branch,
        result,
        uses,
    }
}

/// The single FP registers that an operand consists of.
fn fp_registers(operand: &ArmOperand) -> Vec<u32> {
    let ArmOperandType::Reg(id) = operand.op_type else {
        return Vec::new();
    };
    let id = u32::from(id.0);
    if (ArmReg::ARM_REG_S0..=ArmReg::ARM_REG_S31).contains(&id) {
        vec![id - ArmReg::ARM_REG_S0]
    } else if (ArmReg::ARM_REG_D0..=ArmReg::ARM_REG_D15).contains(&id) {
        let first = 2 * (id - ArmReg::ARM_REG_D0);
        vec![first, first + 1]
    } else {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Price, price as price_of};
    use crate::decode::Decoder;
    use crate::{Error, Function};

    fn price(halves: &[u16]) -> Result<Price, Error> {
        let bytes: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
        let mut function = Function {
            name: "step".to_owned(),
            address: 0,
            size: bytes.len() as u64,
            instructions: Vec::new(),
        };
        function.decode(&Decoder::new().unwrap(), &bytes, 0)?;
        function.price()
    }

    fn cycles(halves: &[u16]) -> u32 {
        let mut code = halves.to_vec();
        code.push(0x4770); // bx lr
        price(&code).unwrap().cycles - 3
    }

    #[test]
    fn each_rule_has_its_price() {
        for (expected, halves) in [
            (3, [0xbf58, 0x6b04].as_slice()), // it pl, ldrpl r4, [r0, #48]
            (2, &[0x6b04]),                   // ldr r4, [r0, #48]
            (2, &[0xf8c2, 0x8008]),           // str.w r8, [r2, #8]
            (3, &[0xe9d6, 0xa800]),           // ldrd sl, r8, [r6]
            (6, &[0xb5f0]),                   // push {r4, r5, r6, r7, lr}
            (5, &[0xe92d, 0x0f00]),           // stmdb sp!, {r8, r9, sl, fp}
            (2, &[0xed96, 0x2a09]),           // vldr s4, [r6, #36]
            (3, &[0xed2d, 0x8b02]),           // vpush {d8}
            (1, &[0xee32, 0x0a40]),           // vsub.f32 s0, s4, s0
            (1, &[0xeef1, 0xfa10]),           // vmrs APSR_nzcv, fpscr
            (14, &[0xee80, 0x0a81]),          // vdiv.f32 s0, s1, s2
            (3, &[0xee00, 0x0a81]),           // vmla.f32 s0, s1, s2
            (1, &[0xea23, 0x030c]),           // bic.w r3, r3, ip
            (12, &[0xfb90, 0xf0f1]),          // sdiv r0, r0, r1
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

    /// `b` over one instruction in place of constants.
    #[test]
    fn a_jump_over_constants_is_straight() {
        assert_eq!(cycles(&[0xe000, 0xbf00, 0xbf00]), 4);
    }

    /// `beq` to the instruction behind the next one, `nop`, `nop`.
    #[test]
    fn a_branch_costs_more_where_it_is_taken() {
        let bytes: Vec<u8> = [0xd000_u16, 0xbf00, 0xbf00]
            .iter()
            .flat_map(|half| half.to_le_bytes())
            .collect();
        let decoded = Decoder::new().unwrap().decode(&bytes, 0).unwrap();
        let cycles = |executed: &[usize]| price_of(executed.iter().map(|&at| &decoded[at])).cycles;
        assert_eq!(cycles(&[0, 1, 2]), 3);
        assert_eq!(cycles(&[0, 2]), 4);
    }

    #[test]
    fn code_that_branches_or_never_ends_is_refused() {
        assert!(price(&[0xd000, 0x4770]).is_err());
        assert!(price(&[0xe7fe, 0x4770]).is_err(), "backwards");
        assert!(price(&[0xbf00]).is_err());
    }
}
