//! dump
use tempco_prove::{
    proof::{Code, Problem},
    spec::Spec,
};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let code = Code::read(a[1].as_ref()).unwrap();
    let spec = Spec::parse(&std::fs::read_to_string(&a[2]).unwrap()).unwrap();
    let p = Problem::new(&spec, code.function(&spec.function).unwrap(), &code.objects).unwrap();
    std::fs::create_dir_all(&a[3]).unwrap();
    std::fs::write(format!("{}/_pre.smt2", a[3]), p.possible()).unwrap();
    for c in p.claims() {
        std::fs::write(format!("{}/{}.smt2", a[3], c.name), p.query(&c)).unwrap();
    }
}
