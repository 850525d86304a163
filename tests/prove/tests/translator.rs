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
    let words = Object {
        name: "w".to_owned(),
        fields: vec![
            field("0", 0, FieldType::Int(32)),
            field("1", 4, FieldType::Int(32)),
        ],
        readable: true,
    };
    let holder = Object {
        name: "q".to_owned(),
        fields: vec![
            field("w", 0, FieldType::Pointer("w")),
            field("n", 4, FieldType::Int(32)),
        ],
        readable: true,
    };
    let plain = Object {
        name: "p".to_owned(),
        fields: vec![
            field("a", 0, FieldType::Float),
            field("n", 4, FieldType::Int(32)),
            field("yes", 8, FieldType::Bool),
        ],
        readable: true,
    };
    vec![plain, words, holder]
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

/// Of a function that has two words and a number.
fn run_on_words(body: &str) -> Result<Translation, Unsupported> {
    let text = format!("define i32 @prove_x(ptr noundef %w, i32 %n) {{\nstart:\n{body}\n}}");
    translate(&parse_functions(&text, "prove_")?[0], &objects())
}

const WORD: &str = "getelementptr inbounds nuw %\"core::sync::atomic::AtomicU32\", ptr %w, i32";

#[test]
fn a_word_that_depends_on_data_is_one_of_those_there_can_be() {
    let body = format!(
        "  %1 = and i32 %n, 1\n  %2 = {WORD} %1\n  \
         %3 = load atomic i32, ptr %2 monotonic, align 4\n  \
         store atomic i32 7, ptr %2 monotonic, align 4\n  ret i32 %3"
    );
    let body = run_on_words(&body).unwrap().body;
    let [first, second] = ["(= v1 (_ bv0 32))", "(not (or false (= v1 (_ bv0 32))))"];
    assert!(
        body.contains(&format!("(ite {second} |w.1| |w.0|)")),
        "{body}"
    );
    assert!(body.contains(&format!("(ite {first} (_ bv7 32) |w.0|)")));
    assert!(body.contains(&format!("(ite {second} (_ bv7 32) |w.1|)")));
    for (number, what) in [("%n", "depends on data"), ("1", "depends on data")] {
        let body = format!("  %2 = {WORD} {number}\n  ret i32 %n");
        let error = run_on_words(&body).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
    let body =
        format!("  %1 = and i32 %n, 2\n  %2 = {WORD} %1\n  %3 = load i32, ptr %2\n  ret i32 %3");
    let error = run_on_words(&body).unwrap_err().to_string();
    assert!(error.contains("byte 8"), "{error}");
}

#[test]
fn stores_are_counted_before_and_after_a_release_fence() {
    let fence = "  fence syncscope(\"singlethread\") release\n";
    let store = "  store atomic i32 %n, ptr %w monotonic, align 4\n";
    let out = run_on_words(&format!("{store}{store}{fence}{store}  ret i32 %n")).unwrap();
    let once = "(ite true (_ bv1 16) (_ bv0 16))";
    let count = |name: &str| {
        let line = format!("(define-fun |{name}| () (_ BitVec 16) ");
        let rest = out.body.split_once(&line).unwrap().1;
        rest.split_once(")\n").unwrap().0.to_owned()
    };
    let twice = format!(
        "(define-fun {} () (_ BitVec 16) (bvadd v",
        count("before.w.0")
    );
    assert!(out.body.contains(&twice), "{}", out.body);
    let single = format!(
        "{} () (_ BitVec 16) (bvadd (_ bv0 16) {once}))",
        count("after.w.0")
    );
    assert!(out.body.contains(&single), "{}", out.body);
    assert_eq!([count("before.w.1"), count("after.w.1")], ["(_ bv0 16)"; 2]);
    assert_eq!(out.demands[0].1, "true", "the fence is always reached");
    let two = run_on_words(&format!("{fence}{fence}  ret i32 %n"));
    assert!(two.unwrap_err().to_string().contains("second release"));
    let acquire = run_on_words("  fence syncscope(\"singlethread\") acquire\n  ret i32 %n");
    assert!(!acquire.unwrap().body.contains("before."));
}

#[test]
fn a_pointer_in_memory_leads_to_its_object() {
    let text = "define i32 @prove_x(ptr noundef %q) {\nstart:\n  \
                %1 = load ptr, ptr %q, align 4\n  %2 = load i32, ptr %1, align 4\n  ret i32 %2\n}";
    let functions = parse_functions(text, "prove_").unwrap();
    let out = translate(&functions[0], &objects()).unwrap();
    assert!(
        out.body.contains("(define-fun v1 () (_ BitVec 32) |w.0|)"),
        "{}",
        out.body
    );
    assert!(out.body.contains("|w'.1|") && out.body.contains("|q'.n|"));
    let number = functions[0].clone();
    let text = text
        .replace("load ptr, ptr %q", "load i32, ptr %q")
        .replace("ptr %1,", "ptr %q,");
    let functions = parse_functions(&text, "prove_").unwrap();
    assert_ne!(functions[0], number);
    assert!(translate(&functions[0], &objects()).is_err());
}

#[test]
fn a_division_is_demanded_to_have_a_quotient() {
    let out = run_on_words("  %1 = sdiv i32 %n, 3\n  ret i32 %1").unwrap();
    assert!(out.body.contains("(bvsdiv |n| (_ bv3 32))"));
    let demands: Vec<&str> = out.demands.iter().map(|(_, term)| term.as_str()).collect();
    assert_eq!(
        demands,
        [
            "(=> true (distinct (_ bv3 32) (_ bv0 32)))",
            "(=> true (not (and (= |n| (_ bv2147483648 32)) (= (_ bv3 32) (_ bv4294967295 32)))))",
        ]
    );
    assert!(run_on_words("  %1 = sdiv exact i32 %n, 3\n  ret i32 %1").is_err());
}

#[test]
fn signs_that_are_said_to_be_equal_are_demanded_to_be() {
    let out = run_on_words(
        "  %1 = icmp samesign ugt i32 %n, 7\n  %2 = select i1 %1, i32 1, i32 0\n  ret i32 %2",
    );
    let demands = out.unwrap().demands;
    assert_eq!(
        demands[0].1,
        "(=> true (bvsge (bvxor |n| (_ bv7 32)) (_ bv0 32)))"
    );
}

#[test]
fn a_shift_that_loses_bits_and_a_result_out_of_its_range_are_demanded_not_to_be() {
    let out = run_on_words("  %1 = shl nuw nsw i32 %n, 1\n  ret i32 %1").unwrap();
    assert_eq!(out.demands.len(), 3);
    assert!(
        out.demands[1]
            .1
            .contains("(bvlshr (bvshl |n| (_ bv1 32)) (_ bv1 32))")
    );
    assert!(
        out.demands[2]
            .1
            .contains("(bvashr (bvshl |n| (_ bv1 32)) (_ bv1 32))")
    );
    let call = "  %1 = tail call noundef range(i32 -8, 9) i32 @llvm.sadd.sat.i32(i32 %n, i32 1)\n";
    let out = run_on_words(&format!("{call}  ret i32 %1")).unwrap();
    let demand = &out.demands[0].1;
    assert!(demand.contains("(_ bv4294967288 32)") && demand.contains("(_ bv9 32)"));
}

#[test]
fn a_block_that_there_is_no_way_around_is_always_reached() {
    let body = "  %1 = icmp eq i32 %n, 0\n  br i1 %1, label %a, label %b\na:\n  \
                br label %c\nb:\n  br label %c\nc:\n  store i32 %n, ptr %w, align 4\n  ret i32 %n";
    let out = run_on_words(body).unwrap();
    assert!(
        out.body
            .contains("(define-fun |w'.0| () (_ BitVec 32) |n|)")
    );
    let out = run_on_words(&body.replace("b:\n  br label %c", "b:\n  ret i32 1")).unwrap();
    assert!(out.body.contains("(ite v1 |n| |w.0|)"), "{}", out.body);
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
