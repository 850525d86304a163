//! The integer core on processors without floating point, beside the f32 core in software.

use std::time::Duration;

use anyhow::{Result, ensure};
use serde_json::{Map, Value, json};
use tempco_qemu::{
    Board, Options, Workspace, build, ensure_qemu, ensure_target_of, run as run_image,
};

/// Instructions per call by board: of the integer core under `fixed`, of the f32 core under `f32`.
pub(super) fn figures(workspace: &Workspace) -> Result<Value> {
    ensure_qemu(workspace)?;
    let mut boards = Map::new();
    for board in [Board::Mps2An385, Board::Microbit] {
        boards.insert(board.name().to_owned(), of_board(workspace, board)?);
    }
    Ok(Value::Object(boards))
}

fn of_board(workspace: &Workspace, board: Board) -> Result<Value> {
    ensure_target_of(workspace, board)?;
    let image = build(workspace, board, "fixed_bench", None)?;
    let options = Options {
        icount: true,
        time_limit: Duration::from_secs(300),
        ..Options::default()
    };
    let run = run_image(&image, board, &[], &options)?;
    ensure!(run.succeeded(), "fixed_bench failed: {:?}", run.log);

    let (mut fixed, mut f32_core, mut sizes) = (Map::new(), Map::new(), Map::new());
    println!("fixed, {board}, per call for three axes  instructions, least and most");
    for line in &run.log {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["bench", name, least, most] => {
                println!("  {name:24} {least:>8} {most:>8}");
                let (least, most): (u32, u32) = (least.parse()?, most.parse()?);
                let figure = json!({ "instructions": [least, most] });
                match name.strip_prefix("f32_") {
                    Some(name) => f32_core.insert(name.to_owned(), figure),
                    None => fixed.insert(name.to_owned(), figure),
                };
            }
            ["size", name, bytes] => {
                println!("  {name:24} {bytes:>8} bytes");
                sizes.insert(name.to_owned(), json!(bytes.parse::<u32>()?));
            }
            _ => {}
        }
    }
    ensure!(fixed.contains_key("step"), "fixed_bench measured nothing");
    Ok(json!({ "fixed": fixed, "f32": f32_core, "sizes": sizes }))
}
