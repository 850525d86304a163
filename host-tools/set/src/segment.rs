//! Segments of the temperature range and what happens where neighbours overlap.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What is applied where two segments overlap.
///
/// In all modes but `None`, the data in an overlap enters the fits of both neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Overlap {
    /// Each segment is fitted up to the middle of the overlap only; the model switches there.
    None,
    /// The model switches in the middle of the overlap.
    Hard,
    /// The mean of both neighbours.
    Mean,
    /// A blend whose weight runs straight from one neighbour to the other.
    Linear,
    /// A blend whose weight `x^2 (3 - 2x)` has no kink at the ends of the overlap.
    Smooth,
    /// Segments that abut, fitted together so that they meet in value and slope.
    Spline,
}

impl Overlap {
    /// The mode as it is written in settings.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hard => "hard",
            Self::Mean => "mean",
            Self::Linear => "linear",
            Self::Smooth => "smooth",
            Self::Spline => "spline",
        }
    }

    const fn blends(self) -> bool {
        matches!(self, Self::Mean | Self::Linear | Self::Smooth)
    }

    /// Whether the pieces of the model meet at their boundaries.
    pub const fn meets(self) -> bool {
        matches!(self, Self::Linear | Self::Smooth | Self::Spline)
    }

    /// Weight of the hotter neighbour at share `x` (0 to 1) of the overlap.
    fn weight(self, x: f64) -> f64 {
        match self {
            Self::None | Self::Hard | Self::Mean | Self::Spline => 0.5,
            Self::Linear => x,
            Self::Smooth => x * x * (3.0 - 2.0 * x),
        }
    }
}

/// A range of temperature \[degC\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Cold end \[degC\].
    pub t_min_c: f64,
    /// Hot end \[degC\].
    pub t_max_c: f64,
}

impl Segment {
    /// Middle of the segment \[degC\].
    pub fn centre_c(&self) -> f64 {
        0.5 * (self.t_min_c + self.t_max_c)
    }

    /// Half the width of the segment \[degC\].
    pub fn half_width_c(&self) -> f64 {
        0.5 * (self.t_max_c - self.t_min_c)
    }
}

impl fmt::Display for Segment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4}..{:.4}", self.t_min_c, self.t_max_c)
    }
}

/// Segments in order of temperature, each reaching the next, no more than two at any point.
#[derive(Clone, Debug, PartialEq)]
pub struct Segmentation {
    segments: Vec<Segment>,
}

/// A stretch of the range with the same neighbours throughout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Cold end \[degC\].
    pub from_c: f64,
    /// Hot end \[degC\].
    pub to_c: f64,
    /// The segment that applies, or the colder of the two that are blended.
    pub segment: usize,
    /// Whether two segments are blended.
    pub blended: bool,
}

impl Piece {
    /// Weight of the next segment at a temperature of this piece.
    pub fn weight(&self, overlap: Overlap, temp_c: f64) -> f64 {
        if self.blended {
            overlap.weight((temp_c - self.from_c) / (self.to_c - self.from_c))
        } else {
            0.0
        }
    }
}

impl Segmentation {
    /// Checks a list of segments.
    ///
    /// # Errors
    /// Says which segments are empty, out of order, apart, or overlap with more than their
    /// neighbours.
    pub fn new(segments: Vec<Segment>) -> Result<Self, SegmentError> {
        if segments.is_empty() || segments.len() > 64 {
            return Err(SegmentError(format!(
                "{} segments: expected 1 to 64",
                segments.len()
            )));
        }
        for segment in &segments {
            let width_c = segment.t_max_c - segment.t_min_c;
            if !(0.1..=1e3).contains(&width_c) {
                return Err(SegmentError(format!(
                    "segment {segment}: expected MIN:MAX in degC, 0.1 to 1000 degC wide"
                )));
            }
        }
        for pair in segments.windows(2) {
            if pair[1].t_min_c <= pair[0].t_min_c || pair[1].t_max_c <= pair[0].t_max_c {
                return Err(SegmentError(format!(
                    "segments {} and {} are not in order of temperature",
                    pair[0], pair[1]
                )));
            }
            if pair[1].t_min_c > pair[0].t_max_c {
                return Err(SegmentError(format!(
                    "segments {} and {} leave a gap",
                    pair[0], pair[1]
                )));
            }
        }
        for three in segments.windows(3) {
            if three[2].t_min_c < three[0].t_max_c {
                return Err(SegmentError(format!(
                    "segments {}, {} and {} overlap all three",
                    three[0], three[1], three[2]
                )));
            }
        }
        Ok(Self { segments })
    }

    /// Segments over a measured range in the paper's manner: one per 24 degC or so, at most four,
    /// with overlaps of an eighth of the range between four.
    pub fn over(t_min_c: f64, t_max_c: f64) -> Result<Self, SegmentError> {
        let count = ((t_max_c - t_min_c) / 24.0).round().clamp(1.0, 4.0) as u32;
        Self::of(count, t_min_c, t_max_c)
    }

    /// A number of segments over a range, with overlaps of half a segment.
    pub fn of(count: u32, t_min_c: f64, t_max_c: f64) -> Result<Self, SegmentError> {
        let unit_c = (t_max_c - t_min_c) / f64::from(4 * count);
        let segments = (0..count).map(|k| Segment {
            t_min_c: t_min_c + unit_c * f64::from((4 * k).saturating_sub(1)),
            t_max_c: if k + 1 == count {
                t_max_c
            } else {
                t_min_c + unit_c * f64::from(4 * k + 5)
            },
        });
        Self::new(segments.collect())
    }

    /// The segments, coldest first.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Cold end of the first segment and hot end of the last \[degC\].
    pub fn range_c(&self) -> (f64, f64) {
        let last = self.segments.len() - 1;
        (self.segments[0].t_min_c, self.segments[last].t_max_c)
    }

    /// Middle of the overlap of each two neighbours \[degC\].
    pub fn switch_points_c(&self) -> Vec<f64> {
        self.segments
            .windows(2)
            .map(|pair| 0.5 * (pair[1].t_min_c + pair[0].t_max_c))
            .collect()
    }

    /// The range of data that enters the fit of each segment.
    pub fn fit_ranges(&self, overlap: Overlap) -> Vec<Segment> {
        let mut ranges = self.segments.clone();
        if overlap == Overlap::None {
            for (k, switch_c) in self.switch_points_c().into_iter().enumerate() {
                ranges[k].t_max_c = switch_c;
                ranges[k + 1].t_min_c = switch_c;
            }
        }
        ranges
    }

    /// The stretches of the range, coldest first.
    pub fn pieces(&self, overlap: Overlap) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut from_c = self.segments[0].t_min_c;
        let mut push = |to_c: f64, segment, blended| {
            if to_c > from_c {
                pieces.push(Piece {
                    from_c,
                    to_c,
                    segment,
                    blended,
                });
                from_c = to_c;
            }
        };
        let switch_points = self.switch_points_c();
        for (k, pair) in self.segments.windows(2).enumerate() {
            if overlap.blends() {
                push(pair[1].t_min_c, k, false);
                push(pair[0].t_max_c, k, true);
            } else {
                push(switch_points[k], k, false);
            }
        }
        push(self.range_c().1, self.segments.len() - 1, false);
        pieces
    }
}

impl FromStr for Segmentation {
    type Err = SegmentError;

    /// Reads `MIN:MAX,MIN:MAX,...` in degC, such as the paper's `-15:15,5:35,25:60,50:80`.
    fn from_str(text: &str) -> Result<Self, SegmentError> {
        let segments = text
            .split(',')
            .map(|part| {
                let (t_min_c, t_max_c) = part
                    .split_once(':')
                    .and_then(|(low, high)| {
                        Some((low.trim().parse().ok()?, high.trim().parse().ok()?))
                    })
                    .ok_or_else(|| {
                        SegmentError(format!("segment `{part}`: expected MIN:MAX in degC"))
                    })?;
                Ok(Segment { t_min_c, t_max_c })
            })
            .collect::<Result<_, _>>()?;
        Self::new(segments)
    }
}

/// A list of segments was refused; the text says which and why.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct SegmentError(String);

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: &str = "-15:15,5:35,25:60,50:80";

    #[test]
    fn the_papers_segments_switch_where_it_says() {
        let paper: Segmentation = PAPER.parse().unwrap();
        assert_eq!(paper.switch_points_c(), [10.0, 30.0, 55.0]);
        assert_eq!(paper.range_c(), (-15.0, 80.0));
        let none = paper.fit_ranges(Overlap::None);
        assert_eq!((none[1].t_min_c, none[1].t_max_c), (10.0, 30.0));
        assert_eq!(paper.fit_ranges(Overlap::Hard), paper.segments());
    }

    #[test]
    fn pieces_cover_the_range_without_gaps() {
        let paper: Segmentation = PAPER.parse().unwrap();
        for (overlap, count) in [
            (Overlap::None, 4),
            (Overlap::Hard, 4),
            (Overlap::Mean, 7),
            (Overlap::Linear, 7),
            (Overlap::Smooth, 7),
        ] {
            let pieces = paper.pieces(overlap);
            assert_eq!(pieces.len(), count, "{overlap:?}");
            assert_eq!(pieces[0].from_c, -15.0);
            assert_eq!(pieces[count - 1].to_c, 80.0);
            assert!(pieces.windows(2).all(|pair| pair[0].to_c == pair[1].from_c));
        }
        let blend = paper.pieces(Overlap::Smooth)[1];
        assert_eq!((blend.from_c, blend.to_c, blend.segment), (5.0, 15.0, 0));
        for (temp_c, weight) in [(5.0, 0.0), (10.0, 0.5), (15.0, 1.0)] {
            assert_eq!(blend.weight(Overlap::Smooth, temp_c), weight);
            assert_eq!(blend.weight(Overlap::Linear, temp_c), weight);
            assert_eq!(blend.weight(Overlap::Mean, temp_c), 0.5);
        }
    }

    #[test]
    fn a_measured_range_is_divided_in_the_papers_manner() {
        let four = Segmentation::over(-20.0, 76.0).unwrap();
        let bounds: Vec<_> = four
            .segments()
            .iter()
            .map(|s| (s.t_min_c, s.t_max_c))
            .collect();
        assert_eq!(
            bounds,
            [(-20.0, 10.0), (-2.0, 34.0), (22.0, 58.0), (46.0, 76.0)]
        );
        assert_eq!(Segmentation::over(10.0, 28.0).unwrap().segments().len(), 1);
        assert_eq!(Segmentation::over(-40.0, 85.0).unwrap().segments().len(), 4);
    }

    #[test]
    fn bad_lists_are_refused_by_name() {
        for (text, part) in [
            ("", "expected MIN:MAX"),
            ("1:2:3", "expected MIN:MAX"),
            ("10:5", "10.0000..5.0000"),
            ("0:nan", "degC wide"),
            ("0:10,20:30", "leave a gap"),
            ("0:10,-5:15", "not in order"),
            ("0:20,5:30,15:40", "overlap all three"),
        ] {
            let error = text.parse::<Segmentation>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
