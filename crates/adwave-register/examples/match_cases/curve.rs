//! Curve of the share of right pairs over their confidence, as SVG.

use super::Tenth;
use std::fmt::Write;

/// Side of the plot in pixels, and its distance from the left and upper border.
const SIDE: f64 = 320.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 20.0;
/// Largest distance of a calibrated share from the confidence.
const TOLERANCE: f64 = 0.05;

/// Draws the share right over the mean confidence of each tenth: a disk with an area by the logarithm of the number of pairs,
/// and the band within 0.05 of equality.
pub(super) fn draw(tenths: &[Tenth; 10]) -> String {
    let (x, y) = (|share: f64| LEFT + SIDE * share, |share: f64| TOP + SIDE * (1.0 - share));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
        LEFT + SIDE + 20.0,
        TOP + SIDE + 50.0
    );
    let corners = [
        (0.0, 0.0),
        (0.0, TOLERANCE),
        (1.0 - TOLERANCE, 1.0),
        (1.0, 1.0),
        (1.0, 1.0 - TOLERANCE),
        (TOLERANCE, 0.0),
    ];
    let band = corners.map(|(a, b)| format!("{:.1},{:.1}", x(a), y(b))).join(" ");
    let _ = writeln!(svg, "<polygon points=\"{band}\" fill=\"#d8e6f3\"/>");
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#888\"/>"
    );
    for k in 0..=5 {
        let share = f64::from(k) / 5.0;
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{share:.1}</text>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{share:.1}</text>",
            x(share),
            y(0.0) + 16.0,
            LEFT - 6.0,
            y(share) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">confidence</text>\n\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">share of right pairs</text>",
        x(0.5),
        y(0.0) + 38.0,
        y(0.5)
    );
    let filled: Vec<&Tenth> = tenths.iter().filter(|tenth| tenth.n > 0).collect();
    let line = filled.iter().map(|t| format!("{:.1},{:.1}", x(t.mean()), y(t.share_right())));
    let line = line.collect::<Vec<_>>().join(" ");
    let _ =
        writeln!(svg, "<polyline points=\"{line}\" fill=\"none\" stroke=\"#1f5f99\" stroke-width=\"1.5\"/>");
    for tenth in filled {
        let radius = 2.0 * (tenth.n as f64).log10().max(0.5).sqrt() + 1.0;
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\" fill=\"#1f5f99\"><title>{} pairs</title></circle>",
            x(tenth.mean()),
            y(tenth.share_right()),
            tenth.n
        );
    }
    svg.push_str("</svg>\n");
    svg
}
