//! The segments of the paper's X gyro, as printed in its table 2, and the table as the unit
//! evaluates it.

use plotters::prelude::*;
use tempco_set::{Overlap, load_set};
use tempco_tests::paper_table_2_of_x;

use crate::{COLOURS, compare};

#[test]
fn the_figure_of_segments_is_true() {
    compare("segments.svg", &draw().unwrap());
}

fn draw() -> Result<String, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("table2.csv");
    std::fs::write(&file, paper_table_2_of_x())?;
    let set = load_set(&file)?;
    let channel = &set.channels[0];
    let polynomials = &channel.axes[0].polynomials;
    assert_eq!(set.settings.overlap, Overlap::Linear);

    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, (900, 420)).into_drawing_area();
    area.fill(&WHITE)?;
    let (low, high) = (-0.04, 0.05);
    let mut chart = ChartBuilder::on(&area)
        .margin(8)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(-15.0..80.0, low..high)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("temperature [degC]")
        .y_desc("bias [pulses/s]")
        .x_label_formatter(&|temp_c| format!("{temp_c:.0}"))
        .draw()?;
    for pair in channel.segments.windows(2) {
        let overlap = [(pair[1].t_min_c, low), (pair[0].t_max_c, high)];
        chart.draw_series([Rectangle::new(overlap, BLACK.mix(0.08).filled())])?;
    }
    let temps =
        |from: f64, to: f64| (0..=300).map(move |i| from + (to - from) * f64::from(i) / 300.0);
    // What is applied, drawn first and broad.
    let cells = channel.table.cells.len() as f64;
    let (first, last) = (channel.segments[0].t_min_c, channel.segments[3].t_max_c);
    let applied = temps(first, last).map(|temp_c| {
        let place = (cells * (temp_c - first) / (last - first)).min(cells - 1e-9);
        let (terms, z) = (channel.table.cells[place as usize][0], place.fract());
        let powers = terms.a.into_iter().rev();
        let bias = powers.fold(0.0, |sum, value| f64::from(value) + z * sum);
        (temp_c, bias)
    });
    chart
        .draw_series(LineSeries::new(applied, BLACK.mix(0.25).stroke_width(9)))?
        .label("applied: linear blend over the overlap")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLACK.mix(0.25).stroke_width(9)));
    for (number, (segment, polynomial)) in channel.segments.iter().zip(polynomials).enumerate() {
        let colour = COLOURS[number];
        let line = temps(segment.t_min_c, segment.t_max_c);
        chart
            .draw_series(LineSeries::new(
                line.map(|temp_c| (temp_c, polynomial.static_bias(temp_c))),
                colour.stroke_width(2),
            ))?
            .label(format!(
                "segment {}: {} to {} degC",
                number + 1,
                segment.t_min_c,
                segment.t_max_c
            ))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperMiddle)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    drop(chart);
    drop(area);
    Ok(svg)
}
