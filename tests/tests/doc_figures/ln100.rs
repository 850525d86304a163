//! The Allan deviation of the simulated unit `ln100` and of the record it is made after, which must
//! lie in `../shared`.

use plotters::coord::Shift;
use plotters::prelude::*;
use tempco_tests::ln100::{Deviations, OCTAVES, factor, record, tau_s, twin};

use crate::{COLOURS, compare};

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Also prints the table of `docs/twin.md`.
#[test]
fn the_figure_of_the_ring_laser_unit_is_true() {
    let Some(up) = record("up") else {
        return;
    };
    let twin = twin(1);
    print_table(&up, &twin);
    let mut svg = String::new();
    draw_all(&mut svg, &up, &twin).unwrap();
    compare("twin-ln100.svg", &svg);
}

fn draw_all(
    svg: &mut String,
    up: &[Deviations; 3],
    twin: &[Deviations; 3],
) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, (900, 380)).into_drawing_area();
    area.fill(&WHITE)?;
    for (axis, panel) in area.split_evenly((1, 3)).iter().enumerate() {
        draw(panel, ["x", "y", "z"][axis], &up[axis], &twin[axis])?;
    }
    area.present()?;
    Ok(())
}

fn print_table(up: &[Deviations; 3], twin: &[Deviations; 3]) {
    println!(
        "| tau [s] | x record | twin | factor | y record | twin | factor | z record | twin | factor |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for i in 0..OCTAVES {
        print!("| {:.4} ", tau_s(i));
        for (record, twin) in up.iter().zip(twin) {
            let (r, t) = (record[i], twin[i]);
            print!("| {r:.3} | {t:.3} | {:.2} ", factor(r, t));
        }
        println!("|");
    }
}

/// One axis: the record as dots, the twin as a line, and a band of a factor 1.5 about the record.
fn draw<DB: DrawingBackend>(
    panel: &DrawingArea<DB, Shift>,
    name: &str,
    record: &Deviations,
    twin: &Deviations,
) -> Drawn<DB> {
    let at = |values: &Deviations| -> Vec<(f64, f64)> {
        let taus = (0..OCTAVES).map(tau_s);
        taus.zip(values.iter().copied()).collect()
    };
    let mut chart = ChartBuilder::on(panel)
        .margin(6)
        .caption(format!("{name} gyro"), ("sans-serif", 15))
        .x_label_area_size(36)
        .y_label_area_size(60)
        .build_cartesian_2d((0.01..50.0).log_scale(), (0.05..500.0).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("averaging time [s]")
        .y_desc("Allan deviation [deg/h]")
        .draw()?;
    let above = at(record)
        .into_iter()
        .map(|(tau, value)| (tau, 1.5 * value));
    let below = at(record)
        .into_iter()
        .map(|(tau, value)| (tau, value / 1.5));
    let band = above.chain(below.rev()).collect::<Vec<_>>();
    chart
        .draw_series([Polygon::new(band, BLACK.mix(0.12))])?
        .label("record x 1.5 and / 1.5")
        .legend(|(x, y)| Rectangle::new([(x, y - 4), (x + 16, y + 4)], BLACK.mix(0.12).filled()));
    chart
        .draw_series(LineSeries::new(at(twin), COLOURS[0].stroke_width(2)))?
        .label("twin, 2 h")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], COLOURS[0]));
    let dots = at(record)
        .into_iter()
        .map(|point| Circle::new(point, 3, COLOURS[1].filled()));
    chart
        .draw_series(dots)?
        .label("record, 300 s")
        .legend(|(x, y)| Circle::new((x + 8, y), 3, COLOURS[1].filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .draw()
}
