//! The page of a batch: every unit once, every code once, nothing from elsewhere.

use tempco_fit::batch::{AxisResult, Outcome, Summary, UnitResult};
use tempco_log::AxisUnit;
use tempco_report::batch_page;
use tempco_set::{Judgement, Rejection, RejectionCode, Warning, WarningCode};

fn unit(serial: &str, sigma_after: f64) -> Outcome {
    let axis = |axis: &str, sigma_after| AxisResult {
        axis: axis.to_owned(),
        unit: AxisUnit::Dph,
        n: 50,
        sigma_before: 1.0,
        sigma_after,
    };
    Outcome {
        serial: serial.to_owned(),
        logs: 1,
        result: Ok(UnitResult {
            rows: 100,
            axes: vec![axis("x", sigma_after), axis("y", 0.25)],
            judgement: Judgement::default(),
        }),
    }
}

/// Five good units, a far one, one with warnings, a rejected one and a failed one.
fn units() -> Vec<Outcome> {
    let mut units: Vec<Outcome> = [0.10, 0.11, 0.09, 0.105, 0.095]
        .iter()
        .zip(1..)
        .map(|(&sigma, number)| unit(&format!("S{number}"), sigma))
        .collect();
    units.extend([
        unit("FAR", 0.9),
        unit("WARNED", 0.12),
        unit("REJECTED", 0.13),
    ]);
    let judgement = |unit: &mut Outcome| unit.result.as_mut().unwrap().judgement.clone();
    let mut warned = judgement(&mut units[6]);
    for axis in ["x", "y"] {
        let code = WarningCode::RateTermsDropped;
        warned
            .warnings
            .push(Warning::of_axis(code, axis, "dropped"));
    }
    let mut rejected = warned.clone();
    let code = RejectionCode::SegmentsDisagree;
    rejected
        .rejections
        .push(Rejection::of_axis(code, "y", "segments disagree"));
    units[6].result.as_mut().unwrap().judgement = warned;
    units[7].result.as_mut().unwrap().judgement = rejected;
    units.push(Outcome {
        result: Err("a.csv:1: no column".to_owned()),
        ..unit("BAD", 0.0)
    });
    units
}

fn page(units: Vec<Outcome>, with_reports: bool) -> String {
    batch_page(&Summary::new(units), with_reports).unwrap()
}

/// Texts between two others, in order.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Vec<&'a str> {
    let parts = text.split(from).skip(1);
    parts.map(|part| part.split(to).next().unwrap()).collect()
}

#[test]
fn every_unit_has_one_row_the_worst_first() {
    let page = page(units(), true);
    let rows = between(&page, "<tr id=\"", "</tr>");
    let serials: Vec<&str> = rows
        .iter()
        .map(|row| {
            let head = between(row, "<th scope=\"row\">", "</th>")[0];
            head.trim_end_matches("</a>").rsplit('>').next().unwrap()
        })
        .collect();
    let expected = [
        "BAD", "REJECTED", "WARNED", "FAR", "S2", "S4", "S1", "S5", "S3",
    ];
    // Of y all improve alike, so it is the worst axis of all but the far unit.
    assert_eq!(serials[..4], expected[..4]);
    let mut all = serials.clone();
    let mut same = expected.to_vec();
    all.sort_unstable();
    same.sort_unstable();
    assert_eq!(all, same);
    for (row, class) in rows.iter().zip(["failed", "reject", "warnings", "accept"]) {
        assert!(row.contains(&format!("class=\"unit {class}\"")), "{row}");
    }
    assert!(page.contains("7 of 9 units accepted"));
    assert!(page.contains("6 accepted, 1 accepted with warnings, 1 rejected, 1 failed."));
    assert!(
        rows[3].contains("+10.0 %") && rows[3].contains("0.9000"),
        "{}",
        rows[3]
    );
}

#[test]
fn every_message_is_there_once() {
    let page = page(units(), true);
    for text in [
        "a.csv:1: no column",
        RejectionCode::SegmentsDisagree.meaning(),
        RejectionCode::SegmentsDisagree.advice(),
        WarningCode::RateTermsDropped.meaning(),
        WarningCode::RateTermsDropped.advice(),
    ] {
        assert_eq!(page.matches(text).count(), 1, "{text}");
    }
    assert!(!page.contains(WarningCode::Spikes.meaning()));
    let code = between(&page, "id=\"code-rate_terms_dropped\"", "</div>")[0];
    for unit in ["WARNED</a> (x, y)", "REJECTED</a> (x, y)", "2 units"] {
        assert!(code.contains(unit), "{code}");
    }
}

#[test]
fn links_lead_to_rows_codes_and_reports() {
    let with = page(units(), true);
    let links = between(&with, "href=\"", "\"");
    let reports: Vec<&&str> = links.iter().filter(|link| !link.starts_with('#')).collect();
    assert_eq!(reports.len(), 8, "the failed unit has no report");
    assert!(reports.contains(&&"FAR/report.html"));
    for link in links.iter().filter_map(|link| link.strip_prefix('#')) {
        assert_eq!(with.matches(&format!("id=\"{link}\"")).count(), 1, "{link}");
    }
    assert!(!page(units(), false).contains("report.html"));
    for outside in [
        "http:", "https:", "<script", "<link", "<img", "url(", "@import",
    ] {
        assert!(!with.contains(outside), "{outside}");
    }
}

#[test]
fn outliers_are_named_in_figure_and_text() {
    let page = page(units(), true);
    let figures = between(&page, "<figure>", "</figure>");
    assert_eq!(figures.len(), 2);
    let [x, y] = [figures[0], figures[1]];
    assert!(
        x.contains("aria-label=\"Bias stability of x over all units"),
        "{x}"
    );
    assert_eq!(x.matches("class=\"unit ").count(), 2 * 8);
    assert!(x.contains("<title>FAR, after: 0.9000 deg/h</title>"));
    let text = between(x, "<figcaption>", "</figcaption>")[0];
    assert!(
        text.contains("median 0.1075 deg/h, from 0.09000 to 0.9000 over 8 units."),
        "{text}"
    );
    assert!(
        text.contains("Outliers: <a href=\"#unit-6\">FAR</a>."),
        "{text}"
    );
    let drawn = x.split("<figcaption>").next().unwrap();
    assert!(
        between(drawn, "<text", "</text>")
            .iter()
            .any(|of| of.ends_with("FAR\n")),
        "{drawn}"
    );
    assert!(!y.contains("Outliers"), "{y}");
}

#[test]
fn texts_are_neither_markup_nor_links_to_elsewhere() {
    let hostile = [
        "javascript:alert(1)",
        "..",
        "../x",
        "<script>\u{1b}\u{202e}\"'",
        "a b#?%",
    ];
    let mut units = hostile.map(|serial| unit(serial, 0.1));
    units[3].result.as_mut().unwrap().axes[0].axis = "<img src=x>".to_owned();
    let page = page(units.into(), true);
    for bad in [
        "<script",
        "<img",
        "\u{1b}",
        "\u{202e}",
        "href=\"..",
        "href=\"javascript:",
    ] {
        assert!(!page.contains(bad), "{bad}");
    }
    assert!(page.contains("href=\"javascript%3Aalert%281%29/report.html\""));
    assert!(page.contains("href=\"a%20b%23%3F%25/report.html\""));
    assert!(page.contains("&lt;img src=x&gt;"));
}

#[test]
fn batches_of_one_or_of_no_set_have_a_page() {
    let one = page(vec![unit("ONLY", 0.1)], true);
    assert!(one.contains("1 of 1 unit accepted"));
    let failed = Outcome {
        result: Err("no".to_owned()),
        ..unit("BAD", 0.0)
    };
    let none = page(vec![failed], true);
    assert!(none.contains("0 of 1 unit accepted") && !none.contains("<figure>"));
}
