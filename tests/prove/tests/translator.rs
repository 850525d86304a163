//! The translator on small pieces of LLVM IR: its output, and what it refuses.

use tempco_prove::ir::{Unsupported, parse_functions};
use tempco_prove::mutant::mutants;
use tempco_prove::smt::{Field, FieldType, Object, Translation, translate};

fn objects() -> Vec<Object> {
    let field = |name: &str, offset, ty| Field {
        name: name.to_owned(),
        offset,
        ty,
    };
    vec![Object {
        name: "p".to_owned(),
        fields: vec![
            field("a", 0, FieldType::Float),
            field("n", 4, FieldType::Int(32)),
            field("yes", 8, FieldType::Bool),
        ],
        readable: true,
    }]
}

fn run(body: &str) -> Result<Translation, Unsupported> {
    let text =
        format!("define float @prove_x(ptr noundef %p, float noundef %x) {{\nstart:\n{body}\n}}");
    translate(&parse_functions(&text, "prove_")?[0], &objects())
}

#[test]
fn arithmetic_rounds_to_nearest_and_nothing_is_reordered() {
    let out = run("  %1 = load float, ptr %p, align 4\n  %2 = fmul float %x, %1\n  ret float %2");
    let body = out.unwrap().body;
    assert!(body.contains("(fp.mul RNE |x| |p.a|)") || body.contains("(fp.mul RNE |x| v1)"));
    assert!(body.contains("(define-fun |result| () F32 v2)"), "{body}");
}

#[test]
fn unordered_comparisons_are_true_of_nan_and_ordered_ones_false() {
    let compare = |predicate: &str| {
        let body = format!(
            "  %1 = fcmp {predicate} float %x, 0.000000e+00\n  \
             %2 = select i1 %1, float %x, float 1.000000e+00\n  ret float %2"
        );
        run(&body).unwrap().body
    };
    assert!(compare("ult").contains("(or (or (fp.isNaN |x|)"));
    assert!(!compare("olt").contains("isNaN"));
}

#[test]
fn a_sign_is_taken_over_only_from_numbers() {
    let body = "  %1 = tail call float @llvm.copysign.f32(float 1.000000e+00, float %x)\n  \
                ret float %1";
    let out = run(body).unwrap();
    assert!(out.body.contains("(ite (fp.isNegative |x|) (fp.neg "));
    assert_eq!(out.demands[0].1, "(=> true (not (fp.isNaN |x|)))");
}

#[test]
fn conversions_saturate_and_take_nan_to_zero() {
    let body = "  %1 = tail call i32 @llvm.fptosi.sat.i32.f32(float %x)\n  \
                %2 = sitofp i32 %1 to float\n  ret float %2";
    let body = run(body).unwrap().body;
    assert!(body.contains("(ite (fp.isNaN |x|) (_ bv0 32)"));
    assert!(body.contains("(_ bv2147483647 32)") && body.contains("(_ bv2147483648 32)"));
}

#[test]
fn what_would_be_poison_is_demanded_not_to_be() {
    let body = "  %1 = getelementptr inbounds nuw i8, ptr %p, i32 4\n  \
                %2 = load i32, ptr %1, align 4\n  %3 = add nsw i32 %2, 1\n  \
                store i32 %3, ptr %1, align 4\n  ret float %x";
    let out = run(body).unwrap();
    assert_eq!(out.demands.len(), 1);
    assert!(out.demands[0].1.contains("sign_extend 1"));
    assert!(out.body.contains("|p'.n|"));
}

#[test]
fn a_store_counts_only_where_its_block_is_reached() {
    let body = "  %1 = fcmp ogt float %x, 0.000000e+00\n  \
                br i1 %1, label %yes, label %no\nyes:\n  store float %x, ptr %p, align 4\n  \
                br label %no\nno:\n  \
                %2 = phi float [ 1.000000e+00, %start ], [ %x, %yes ]\n  ret float %2";
    let body = run(body).unwrap().body;
    assert!(body.contains("(ite v1 |x| |p.a|)"), "{body}");
    assert!(body.contains("(ite (and (not v1)") || body.contains("(ite v1 |x|"));
}

#[test]
fn what_is_not_understood_is_refused() {
    for (body, what) in [
        (
            "  %1 = call float @llvm.sqrt.f32(float %x)\n  ret float %1",
            "sqrt",
        ),
        (
            "  %1 = call float @llvm.fma.f32(float %x, float %x, float %x)\n  ret float %1",
            "fma",
        ),
        (
            "  %1 = call float @sinf(float %x)\n  ret float %1",
            "a call",
        ),
        (
            "  %1 = getelementptr inbounds i8, ptr %p, i32 2\n  %2 = load float, ptr %1, align 4\n  ret float %2",
            "byte 2",
        ),
        (
            "  %1 = load i16, ptr %p, align 4\n  ret float %x",
            "another size",
        ),
        (
            "  store i16 0, ptr %p, align 4\n  ret float %x",
            "parts of fields",
        ),
        ("  %1 = udiv i32 4, 2\n  ret float %x", "udiv"),
        ("  ret float %y", "before it is known"),
        ("  br label %start", "a loop"),
        ("  ret float poison", "poison"),
    ] {
        let error = run(body).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}

#[test]
fn seeded_bugs_are_of_the_kinds_that_matter() {
    let text = "define i16 @prove_x(float noundef %x) {\nstart:\n  \
                %1 = fcmp ole float %x, 1.000000e+00\n  %2 = fcmp oge float %x, 0.000000e+00\n  \
                %3 = and i1 %1, %2\n  %4 = select i1 %3, i16 1, i16 0\n  ret i16 %4\n}";
    let names: Vec<String> = mutants(&parse_functions(text, "prove_").unwrap()[0])
        .into_iter()
        .map(|mutant| mutant.name)
        .collect();
    assert_eq!(names.len(), 8, "{names:?}");
    for kind in [
        "off by equality",
        "NaN passes",
        "and for or",
        "left out",
        "always made",
    ] {
        assert!(names.iter().any(|name| name.contains(kind)), "{kind}");
    }
}
