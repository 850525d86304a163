//! From bytes to instructions.

use capstone::arch::arm::{
    ArchExtraMode, ArchMode, ArmCC, ArmInsn, ArmInsnDetail, ArmOperand, ArmOperandType, ArmReg,
};
use capstone::prelude::*;
use capstone::{AccessType, Insn, InsnDetail};

use crate::cycles::cost;
use crate::{Arithmetic, Flow, Instruction, Stack};

/// A disassembler for Thumb code of Cortex-M.
pub(crate) struct Decoder(Capstone);

impl Decoder {
    pub(crate) fn new() -> Result<Self, capstone::Error> {
        Capstone::new()
            .arm()
            .mode(ArchMode::Thumb)
            .extra_mode([ArchExtraMode::MClass, ArchExtraMode::V8].into_iter())
            .detail(true)
            .build()
            .map(Self)
    }

    /// All instructions of `code`; an error says how many bytes could be decoded.
    pub(crate) fn decode(&self, code: &[u8], address: u64) -> Result<Vec<Instruction>, usize> {
        let decoded = self.0.disasm_all(code, address).map_err(|_| 0_usize)?;
        let length: usize = decoded.iter().map(|insn| insn.len()).sum();
        if length != code.len() {
            return Err(length);
        }
        decoded
            .iter()
            .map(|insn| {
                let detail = self.0.insn_detail(insn).map_err(|_| 0_usize)?;
                Ok(instruction(insn, &detail))
            })
            .collect()
    }
}

fn instruction(insn: &Insn<'_>, detail: &InsnDetail<'_>) -> Instruction {
    let arch = detail.arch_detail();
    // The decoder is for Arm only, so it has Arm's details.
    let arm = arch.arm().expect("details of an Arm instruction");
    let operands: Vec<ArmOperand> = arm.operands().collect();
    let mnemonic = insn.mnemonic().unwrap_or_default();
    let flow = flow(insn, &operands);
    Instruction {
        address: insn.address(),
        text: format!("{mnemonic} {}", insn.op_str().unwrap_or_default())
            .trim_end()
            .to_owned(),
        conditional: is_conditional(insn, arm),
        flow,
        stack: stack(insn, arm, &operands),
        arithmetic: arithmetic(insn, mnemonic),
        cost: cost(insn, &operands, flow),
    }
}

pub(crate) fn is(insn: &Insn<'_>, kinds: &[ArmInsn]) -> bool {
    kinds.iter().any(|kind| insn.id().0 == *kind as u32)
}

fn is_conditional(insn: &Insn<'_>, arm: &ArmInsnDetail<'_>) -> bool {
    use ArmInsn::{ARM_INS_CBNZ, ARM_INS_CBZ, ARM_INS_IT};
    is(insn, &[ARM_INS_CBZ, ARM_INS_CBNZ])
        || (!is(insn, &[ARM_INS_IT])
            && !matches!(arm.cc(), ArmCC::ARM_CC_AL | ArmCC::ARM_CC_INVALID))
}

fn flow(insn: &Insn<'_>, operands: &[ArmOperand]) -> Flow {
    use ArmInsn::*;
    let target = operands.iter().find_map(|operand| match operand.op_type {
        ArmOperandType::Imm(target) => Some(u64::from(target as u32)),
        _ => None,
    });
    if is(insn, &[ARM_INS_TBB, ARM_INS_TBH]) {
        return Flow::Table;
    }
    if is(insn, &[ARM_INS_B, ARM_INS_CBZ, ARM_INS_CBNZ]) {
        return target.map_or(Flow::Indirect, Flow::Jump);
    }
    if is(insn, &[ARM_INS_BL, ARM_INS_BLX, ARM_INS_BLXNS]) {
        return target.map_or(Flow::Indirect, Flow::Call);
    }
    if is(insn, &[ARM_INS_BX, ARM_INS_BXNS]) {
        let to_caller = operands
            .iter()
            .any(|operand| is_register(operand, ArmReg::ARM_REG_LR));
        return if to_caller {
            Flow::Return
        } else {
            Flow::Indirect
        };
    }
    match operands
        .iter()
        .any(|operand| writes(operand, ArmReg::ARM_REG_PC))
    {
        false => Flow::Next,
        true if is(insn, &[ARM_INS_POP, ARM_INS_LDM]) => Flow::Return,
        // `ldr pc, [sp], #4` is a `pop {pc}`.
        true if is(insn, &[ARM_INS_LDR]) && reads_stack(operands) => Flow::Return,
        true => Flow::Indirect,
    }
}

fn stack(insn: &Insn<'_>, arm: &ArmInsnDetail<'_>, operands: &[ArmOperand]) -> Stack {
    use ArmInsn::*;
    let registers = operands
        .iter()
        .filter(|operand| matches!(operand.op_type, ArmOperandType::Reg(_)));
    let on_stack = operands
        .first()
        .is_some_and(|operand| is_register(operand, ArmReg::ARM_REG_SP));
    if is(insn, &[ARM_INS_PUSH]) {
        return Stack::Sinks(4 * registers.count() as u32);
    }
    if is(insn, &[ARM_INS_VPUSH]) {
        return Stack::Sinks(registers.map(float_size).sum());
    }
    if is(insn, &[ARM_INS_STMDB]) && on_stack {
        return sinks_if(arm.writeback(), 4 * (registers.count() as u32 - 1));
    }
    if is(insn, &[ARM_INS_VSTMDB]) && on_stack {
        return Stack::Sinks(registers.skip(1).map(float_size).sum());
    }
    if is(insn, &[ARM_INS_POP, ARM_INS_VPOP])
        || (is(insn, &[ARM_INS_LDM, ARM_INS_VLDMIA]) && on_stack)
    {
        return Stack::Kept;
    }
    // Loads and stores that move the stack pointer along: `str lr, [sp, #-8]!`.
    if let Some(offset) = operands.iter().find_map(stack_offset) {
        let rises = is(insn, &[ARM_INS_LDR, ARM_INS_LDRD]);
        return match arm.writeback() {
            true if rises => Stack::Kept,
            true => sinks_if(offset < 0, offset.unsigned_abs()),
            false => Stack::Kept,
        };
    }
    let writes_stack = operands
        .iter()
        .any(|operand| writes(operand, ArmReg::ARM_REG_SP));
    match (
        writes_stack,
        operands.last().map(|operand| &operand.op_type),
    ) {
        (true, Some(ArmOperandType::Imm(by))) if is(insn, &[ARM_INS_SUB, ARM_INS_SUBW]) => {
            Stack::Sinks(*by as u32)
        }
        (true, Some(ArmOperandType::Imm(_))) if is(insn, &[ARM_INS_ADD, ARM_INS_ADDW]) => {
            Stack::Kept
        }
        (true, _) => Stack::Unknown,
        (false, _) if is(insn, &[ARM_INS_MSR]) => {
            let text = insn.op_str().unwrap_or_default();
            if text.contains("sp") {
                Stack::Unknown
            } else {
                Stack::Kept
            }
        }
        (false, _) => Stack::Kept,
    }
}

fn sinks_if(sinks: bool, bytes: u32) -> Stack {
    if sinks {
        Stack::Sinks(bytes)
    } else {
        Stack::Unknown
    }
}

fn is_register(operand: &ArmOperand, register: ArmReg::Type) -> bool {
    matches!(operand.op_type, ArmOperandType::Reg(id) if u32::from(id.0) == register)
}

fn writes(operand: &ArmOperand, register: ArmReg::Type) -> bool {
    is_register(operand, register)
        && matches!(
            operand.access,
            Some(AccessType::WriteOnly | AccessType::ReadWrite)
        )
}

fn reads_stack(operands: &[ArmOperand]) -> bool {
    operands
        .iter()
        .any(|operand| stack_offset(operand).is_some())
}

/// The offset of an operand in memory relative to the stack pointer.
fn stack_offset(operand: &ArmOperand) -> Option<i32> {
    match operand.op_type {
        ArmOperandType::Mem(memory) if u32::from(memory.base().0) == ArmReg::ARM_REG_SP => {
            Some(memory.disp())
        }
        _ => None,
    }
}

/// Bytes of a floating-point register.
fn float_size(operand: &ArmOperand) -> u32 {
    let ArmOperandType::Reg(id) = operand.op_type else {
        return 0;
    };
    let single = ArmReg::ARM_REG_S0..=ArmReg::ARM_REG_S31;
    if single.contains(&u32::from(id.0)) {
        4
    } else {
        8
    }
}

fn arithmetic(insn: &Insn<'_>, mnemonic: &str) -> Arithmetic {
    use ArmInsn::*;
    // Conversions to and from doubles name them too.
    if mnemonic.contains(".f64") {
        return Arithmetic::Double;
    }
    if is(
        insn,
        &[ARM_INS_SDIV, ARM_INS_UDIV, ARM_INS_VDIV, ARM_INS_VSQRT],
    ) {
        return Arithmetic::Division;
    }
    if is(
        insn,
        &[ARM_INS_VFMA, ARM_INS_VFMS, ARM_INS_VFNMA, ARM_INS_VFNMS],
    ) {
        return Arithmetic::Fused;
    }
    if is(
        insn,
        &[ARM_INS_VMLA, ARM_INS_VMLS, ARM_INS_VNMLA, ARM_INS_VNMLS],
    ) {
        return Arithmetic::Chained;
    }
    Arithmetic::Other
}
