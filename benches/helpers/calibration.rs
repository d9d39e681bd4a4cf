//! Chart of the noise that the denoiser finds over the true noise, as SVG.

use std::fmt::Write;

/// Denoised cloud in the chart.
#[derive(Clone, Copy, Debug)]
pub struct CalibrationDot {
    /// True noise in spacings.
    pub truth: f64,
    /// Printed noise in spacings.
    pub found: f64,
    /// Printed interval in spacings.
    pub interval: [f64; 2],
    /// True if noise larger than about half the distance of the points was found.
    pub is_strong: bool,
}

impl CalibrationDot {
    /// True if the printed interval holds the true noise.
    pub fn is_covered(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.truth)
    }
}

/// Side of the plot in pixels, and its distance from the left and upper border.
const SIDE: f64 = 420.0;
const LEFT: f64 = 64.0;
const TOP: f64 = 20.0;

/// Labeled values of both axes.
const TICKS: [f64; 9] = [0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0];

/// Names and colors of the clouds without and with strong noise.
const GROUPS: [(&str, &str); 2] = [("weak noise", "#1f5f99"), ("strong noise", "#c2571a")];

/// Draws one dot for each cloud over logarithmic axes, the line of equality, and for the clouds without and with strong
/// noise the band in which the printed interval holds the true noise.
pub fn calibration_svg(dots: &[CalibrationDot]) -> String {
    let values = || dots.iter().flat_map(|dot| [dot.truth, dot.found]);
    let low = 0.8 * values().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let high = 1.25 * values().fold(0.0, f64::max);
    // Noise that is not found at all lies on the lower border.
    let share = |v: f64| (v.max(low) / low).ln() / (high / low).ln();
    let (x, y) = (|v: f64| LEFT + SIDE * share(v), |v: f64| TOP + SIDE * (1.0 - share(v)));
    let (width, height) = (LEFT + SIDE + 20.0, TOP + SIDE + 54.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
         <clipPath id=\"plot\"><rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\"/></clipPath>\n"
    );
    let own = |strong: bool| dots.iter().filter(move |dot| dot.is_strong == strong && dot.found > 0.0);
    for (k, (_, color)) in GROUPS.iter().enumerate() {
        let ends = own(k == 1).fold([f64::INFINITY, 0.0], |[a, b], dot| [dot.truth.min(a), dot.truth.max(b)]);
        let Some(dot) = own(k == 1).next() else { continue };
        let [least, most] = dot.interval.map(|end| dot.found / end);
        let corners = [(ends[0], least), (ends[1], least), (ends[1], most), (ends[0], most)];
        let corners = corners.map(|(truth, ratio)| format!("{:.1},{:.1}", x(truth), y(ratio * truth)));
        let _ = writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"{color}\" opacity=\"0.15\" clip-path=\"url(#plot)\"/>",
            corners.join(" ")
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{SIDE}\" height=\"{SIDE}\" fill=\"none\" stroke=\"#888\"/>\n\
         <line x1=\"{LEFT}\" y1=\"{0}\" x2=\"{1}\" y2=\"{TOP}\" stroke=\"#888\"/>",
        TOP + SIDE,
        LEFT + SIDE
    );
    for tick in TICKS.into_iter().filter(|tick| (low..=high).contains(tick)) {
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {1}v5M{LEFT} {2:.1}h-5\" stroke=\"#888\"/>\n\
             <text x=\"{0:.1}\" y=\"{3}\" text-anchor=\"middle\">{tick}</text>\n\
             <text x=\"{4}\" y=\"{5:.1}\" text-anchor=\"end\">{tick}</text>",
            x(tick),
            TOP + SIDE,
            y(tick),
            TOP + SIDE + 18.0,
            LEFT - 8.0,
            y(tick) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{0}\" y=\"{1}\" text-anchor=\"middle\">true noise, spacings</text>\n\
         <text transform=\"translate(18 {2}) rotate(-90)\" text-anchor=\"middle\">noise found, spacings</text>",
        LEFT + 0.5 * SIDE,
        TOP + SIDE + 42.0,
        TOP + 0.5 * SIDE
    );
    for (k, (name, color)) in GROUPS.iter().enumerate() {
        for dot in dots.iter().filter(|dot| dot.is_strong == (k == 1)) {
            let (cx, cy) = (x(dot.truth), y(dot.found));
            let _ = writeln!(
                svg,
                "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"2.5\" fill=\"{color}\" opacity=\"0.7\"/>"
            );
        }
        let line = TOP + 20.0 + 18.0 * k as f64;
        let _ = writeln!(
            svg,
            "<circle cx=\"{0}\" cy=\"{1}\" r=\"4\" fill=\"{color}\"/>\n\
             <text x=\"{2}\" y=\"{line}\">{name} found, and its interval</text>",
            LEFT + 16.0,
            line - 4.0,
            LEFT + 28.0
        );
    }
    svg.push_str("</svg>\n");
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cloud_is_a_dot_inside_the_plot() {
        let dot = |truth: f64, found: f64, is_strong: bool| CalibrationDot {
            truth,
            found,
            interval: [0.6 * found, 1.8 * found],
            is_strong,
        };
        let dots = [dot(0.05, 0.05, false), dot(0.3, 0.1, false), dot(3.0, 2.8, true), dot(1.0, 0.0, false)];
        assert_eq!(dots.map(|dot| dot.is_covered()), [true, false, true, false]);
        let svg = calibration_svg(&dots);
        let places: Vec<f64> = svg
            .split("<circle cx=\"")
            .skip(1)
            .map(|rest| rest.split('"').next().and_then(|x| x.parse().ok()).unwrap())
            .collect();
        // Two more circles are in the legend.
        assert_eq!(places.len(), dots.len() + 2);
        assert!(places.iter().all(|x| (LEFT..=LEFT + SIDE).contains(x)), "{places:?}");
        assert_eq!(svg.matches("<polygon").count(), 2);
    }
}
