//! The checks on functions that were put together by hand: each finds what it is there for.
//! The bytes were encoded by hand; the text beside them is what they are.

use crate::decode::Decoder;
use crate::{Arithmetic, CallGraph, Error, Flow, Function, Image, Kernel, Stack};

const NOP: &[u8] = &[0x00, 0xbf];
const RETURN: &[u8] = &[0x70, 0x47]; // bx lr
const ADDRESS: u64 = 0x1000;

fn function(name: &str, address: u64, code: &[&[u8]]) -> Function {
    let code = code.concat();
    let mut function = Function {
        name: format!("tempco::{name}"),
        address,
        size: code.len() as u64,
        instructions: Vec::new(),
    };
    let decoder = Decoder::new().unwrap();
    function.decode(&decoder, &code, address).unwrap();
    function
}

fn kernel(code: &[&[u8]]) -> Kernel {
    let image = Image::of(vec![function("step", ADDRESS, code)]);
    Kernel::read(&image, "step").unwrap()
}

/// What one instruction does to the stack pointer.
fn stack(code: &[u8]) -> Stack {
    function("step", ADDRESS, &[code]).instructions[0].stack
}

#[test]
fn a_plain_function_has_nothing_to_remark() {
    let found = kernel(&[NOP, RETURN]);
    assert_eq!((found.instructions, found.stack), (2, 0));
    assert!(found.branches.is_empty() && found.loops.is_empty() && found.callees.is_empty());
}

#[test]
fn branches_and_loops_are_found() {
    // beq .+4
    let found = kernel(&[&[0x00, 0xd0], NOP, NOP, RETURN]);
    assert_eq!((found.branches.len(), found.loops.len()), (1, 0));
    // cbz r0, .+4
    let found = kernel(&[&[0x00, 0xb1], NOP, NOP, RETURN]);
    assert_eq!((found.branches.len(), found.loops.len()), (1, 0));
    // bne .-2
    let found = kernel(&[NOP, &[0xfd, 0xd1], RETURN]);
    assert_eq!((found.branches.len(), found.loops.len()), (1, 1));
    // b .-2
    let found = kernel(&[NOP, &[0xfd, 0xe7]]);
    assert_eq!((found.branches.len(), found.loops.len()), (0, 1));
    // tbb [pc, r0]
    let found = kernel(&[&[0xdf, 0xe8, 0x00, 0xf0]]);
    assert_eq!(found.loops.len(), 1);
}

#[test]
fn a_conditional_return_is_a_branch_and_a_selection_is_not() {
    // it eq; bxeq lr
    let found = kernel(&[&[0x08, 0xbf], RETURN, RETURN]);
    assert_eq!((found.branches.len(), found.predicated), (1, 0));
    // it mi; vmovmi.f32 s0, s1
    let found = kernel(&[&[0x48, 0xbf], &[0xb0, 0xee, 0x60, 0x0a], RETURN]);
    assert_eq!((found.branches.len(), found.predicated), (0, 1));
}

#[test]
fn arithmetic_is_told_apart() {
    use Arithmetic::{Chained, Division, Double, Fused, Other};
    for (code, expected) in [
        ([0x80, 0xee, 0x20, 0x0a], Division), // vdiv.f32 s0, s0, s1
        ([0xb1, 0xee, 0xc0, 0x0a], Division), // vsqrt.f32 s0, s0
        ([0x90, 0xfb, 0xf1, 0xf0], Division), // sdiv r0, r0, r1
        ([0xb0, 0xfb, 0xf1, 0xf0], Division), // udiv r0, r0, r1
        ([0xa0, 0xee, 0x81, 0x0a], Fused),    // vfma.f32 s0, s1, s2
        ([0xa0, 0xee, 0xc1, 0x0a], Fused),    // vfms.f32 s0, s1, s2
        ([0x00, 0xee, 0x81, 0x0a], Chained),  // vmla.f32 s0, s1, s2
        ([0x00, 0xee, 0xc1, 0x0a], Chained),  // vmls.f32 s0, s1, s2
        ([0x31, 0xee, 0x02, 0x0b], Double),   // vadd.f64 d0, d1, d2
        ([0x30, 0xee, 0x81, 0x0a], Other),    // vadd.f32 s0, s1, s2
    ] {
        let function = function("step", ADDRESS, &[&code]);
        let instruction = &function.instructions[0];
        assert_eq!(instruction.arithmetic, expected, "{}", instruction.text);
    }
}

#[test]
fn every_way_to_move_the_stack_pointer_is_understood_or_refused() {
    assert_eq!(stack(&[0x10, 0xb5]), Stack::Sinks(8)); // push {r4, lr}
    assert_eq!(stack(&[0x2d, 0xe9, 0xf0, 0x4f]), Stack::Sinks(36)); // push.w {r4-r11, lr}
    assert_eq!(stack(&[0x2d, 0xed, 0x10, 0x8b]), Stack::Sinks(64)); // vpush {d8-d15}
    assert_eq!(stack(&[0x2d, 0xed, 0x03, 0x8a]), Stack::Sinks(12)); // vpush {s16-s18}
    assert_eq!(stack(&[0x84, 0xb0]), Stack::Sinks(16)); // sub sp, #16
    assert_eq!(stack(&[0xad, 0xf5, 0x00, 0x5d]), Stack::Sinks(8192)); // sub.w sp, sp, #8192
    assert_eq!(stack(&[0x4d, 0xf8, 0x04, 0xbd]), Stack::Sinks(4)); // str r11, [sp, #-4]!
    assert_eq!(stack(&[0x6d, 0xe9, 0x02, 0x01]), Stack::Sinks(8)); // strd r0, r1, [sp, #-8]!
    for kept in [
        &[0x10, 0xbd][..],         // pop {r4, pc}
        &[0x04, 0xb0],             // add sp, #16
        &[0x5d, 0xf8, 0x04, 0xbb], // ldr r11, [sp], #4
        &[0xbd, 0xec, 0x10, 0x8b], // vpop {d8-d15}
        &[0x01, 0x90],             // str r0, [sp, #4]
        &[0x6f, 0x46],             // mov r7, sp
        &[0x8d, 0xed, 0x01, 0x0a], // vstr s0, [sp, #4]
    ] {
        assert_eq!(stack(kept), Stack::Kept, "{kept:x?}");
    }
    for unknown in [
        &[0xbd, 0x46][..],         // mov sp, r7
        &[0xad, 0xeb, 0x00, 0x0d], // sub.w sp, sp, r0
        &[0x80, 0xf3, 0x08, 0x88], // msr msp, r0
    ] {
        assert_eq!(stack(unknown), Stack::Unknown, "{unknown:x?}");
    }
}

/// `push {r4, lr}; bl target; pop {r4, pc}`, at an address.
fn caller(name: &str, address: u64, target: u64) -> Function {
    let offset = target as i64 - (address as i64 + 2 + 4);
    let half = (offset >> 1) as u32;
    let first = 0xf000 | ((half >> 11) & 0x3ff) as u16 | if offset < 0 { 0x400 } else { 0 };
    let second = 0xf800 | (half & 0x7ff) as u16;
    let call = [first.to_le_bytes(), second.to_le_bytes()].concat();
    function(name, address, &[&[0x10, 0xb5], &call, &[0x10, 0xbd]])
}

#[test]
fn the_stack_is_summed_along_the_calls() {
    let image = Image::of(vec![
        caller("a", 0x1000, 0x2000),
        caller("b", 0x2000, 0x3000),
        function("c", 0x3000, &[&[0x84, 0xb0], &[0x04, 0xb0], RETURN]),
    ]);
    let graph = CallGraph::from(&image, 0x1000, |_| false).unwrap();
    let depth = graph.deepest_stack().unwrap();
    assert_eq!(depth.bytes, 8 + 8 + 16);
    let names: Vec<&str> = depth.path.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["tempco::a", "tempco::b", "tempco::c"]);
    let graph = CallGraph::from(&image, 0x1000, |name| name == "tempco::c").unwrap();
    assert_eq!(graph.deepest_stack().unwrap().bytes, 16);
}

#[test]
fn recursion_is_refused() {
    let image = Image::of(vec![
        caller("a", 0x1000, 0x2000),
        caller("b", 0x2000, 0x1000),
    ]);
    let graph = CallGraph::from(&image, 0x1000, |_| false).unwrap();
    let error = graph.deepest_stack().unwrap_err();
    assert_eq!(
        error.to_string(),
        "recursion: tempco::a -> tempco::b -> tempco::a"
    );
}

#[test]
fn calls_that_cannot_be_followed_are_refused() {
    let blx = function("step", ADDRESS, &[&[0x80, 0x47]]); // blx r0
    assert_eq!(blx.instructions[0].flow, Flow::Indirect);
    let bx = function("step", ADDRESS, &[&[0x18, 0x47]]); // bx r3
    assert_eq!(bx.instructions[0].flow, Flow::Indirect);
    let image = Image::of(vec![blx]);
    let error = Kernel::read(&image, "step").unwrap_err();
    assert!(matches!(error, Error::Indirect { .. }), "{error}");
    let image = Image::of(vec![caller("step", 0x1000, 0x9000)]);
    let error = Kernel::read(&image, "step").unwrap_err();
    assert!(matches!(error, Error::Target { .. }), "{error}");
}

#[test]
fn bytes_that_are_no_instructions_are_refused() {
    let decoder = Decoder::new().unwrap();
    // A coprocessor instruction that Cortex-M does not have, behind a good one.
    let code = [NOP, &[0xff, 0xff, 0xff, 0xff]].concat();
    assert_eq!(decoder.decode(&code, ADDRESS), Err(2));
}
