use super::*;

fn chart(points: Vec<[f64; 2]>, scale: AxisScale, mark: Mark) -> Chart {
    let axis = ChartAxis { label: "σ".to_owned(), scale, ..ChartAxis::default() };
    let series = vec![Series { label: "one".to_owned(), mark, points }];
    Chart { title: "t".to_owned(), x: axis.clone(), y: axis, series }
}

/// Number of pixels in the color of a series.
fn inked(chart: &Chart, color: [u8; 3]) -> usize {
    chart.picture(300, 200).unwrap().rgba.chunks_exact(4).filter(|p| p[..3] == color).count()
}

const FIRST: [u8; 3] = [0, 114, 178];
const SECOND: [u8; 3] = [213, 94, 0];

#[test]
fn what_has_no_place_on_its_axis_is_refused() {
    let error = |points, scale| chart(points, scale, Mark::Points).svg(200, 150).unwrap_err().to_string();
    assert!(error(vec![], AxisScale::Linear).contains("no points"));
    assert!(error(vec![[1.0, f64::NAN]], AxisScale::Linear).contains("NaN"));
    assert!(error(vec![[1.0, 0.0]], AxisScale::Log10).contains("above 0"));
    assert!(chart(vec![[1.0, 1.0]], AxisScale::Linear, Mark::Line).picture(0, 5).is_err());
}

#[test]
fn charts_are_the_same_each_time_and_show_their_series_by_every_mark() {
    for scale in [AxisScale::Linear, AxisScale::Log10] {
        for mark in [Mark::Line, Mark::Points, Mark::Bars, Mark::Stems] {
            let chart = chart(vec![[1.0, 1.0], [10.0, 100.0]], scale, mark);
            assert_eq!(chart.picture(300, 200).unwrap(), chart.picture(300, 200).unwrap());
            assert!(inked(&chart, FIRST) > 0, "{scale:?} {mark:?}");
            assert!(chart.svg(300, 200).unwrap().starts_with("<svg"));
        }
    }
}

#[test]
fn a_bar_of_twice_the_value_has_twice_the_area() {
    let of = |height| {
        let mut chart = chart(vec![[0.0, height]], AxisScale::Linear, Mark::Bars);
        let other = Series { label: "two".to_owned(), mark: Mark::Bars, points: vec![[0.0, 4.0]] };
        chart.series.push(other);
        (inked(&chart, FIRST) as f64, inked(&chart, SECOND) as f64)
    };
    // The swatches of the legend are equal in both; the tolerance is a row of pixels.
    let ((one, whole), (two, also_whole)) = (of(1.0), of(2.0));
    assert_eq!(whole, also_whole);
    let quarter = (two - one) / (whole - (2.0 * one - two));
    assert!((quarter - 0.25).abs() < 0.02, "{quarter}");
}

#[test]
fn bars_of_several_series_do_not_hide_each_other_and_carry_names() {
    let mut chart = chart(vec![[0.0, 3.0], [1.0, 4.0]], AxisScale::Linear, Mark::Bars);
    let second = Series { label: "two".to_owned(), mark: Mark::Bars, points: vec![[0.0, 4.0], [1.0, 3.0]] };
    chart.series.push(second);
    chart.x.names = vec!["kitten".to_owned(), "horse".to_owned()];
    let [a, b] = [FIRST, SECOND].map(|color| inked(&chart, color));
    assert!(a.abs_diff(b) * 50 < a, "{a} {b}");
    let svg = chart.svg(300, 200).unwrap();
    assert!(svg.contains("kitten") && svg.contains("horse") && svg.contains("two"));
}

#[test]
fn a_sheet_shows_each_of_its_charts() {
    let one = chart(vec![[1.0, 1.0], [2.0, 2.0]], AxisScale::Linear, Mark::Line);
    let two = Chart { title: "second".to_owned(), ..one.clone() };
    let sheet = Sheet { charts: vec![one, two], columns: 2 };
    assert!(sheet.svg(600, 200).unwrap().contains("second"));
    assert_eq!(sheet.picture(600, 200).unwrap().width, 600);
    assert!(sheet.picture(100, 100).is_err(), "charts of 50 pixels");
    assert!(Sheet::default().svg(300, 200).is_err());
}

#[test]
fn a_pattern_has_a_square_for_each_entry_and_shows_all_of_a_large_one() {
    let pattern = |n: usize, entries: Vec<[u32; 2]>| SparsityPattern {
        title: "Φ".to_owned(),
        n_rows: n,
        n_columns: n,
        entries,
    };
    let dark = |p: &SparsityPattern| {
        p.picture(200, 200).unwrap().rgba.chunks_exact(4).filter(|p| p[..3] == [0, 80, 140]).count()
    };
    let [one, two] = [vec![[0, 0]], vec![[0, 0], [2, 1]]].map(|e| dark(&pattern(3, e)));
    assert!(one > 1000 && two == 2 * one, "{one} {two}");
    let far = pattern(100_000, vec![[7, 99_999]]);
    let ground = |p: &&[u8]| p[..3] == [244, 244, 244];
    let picture = far.picture(200, 200).unwrap();
    let shown = picture.rgba.chunks_exact(4).filter(|p| p[2].saturating_sub(p[0]) > 40).count();
    assert!(shown >= 1 && picture.rgba.chunks_exact(4).filter(ground).count() > 10_000, "{shown}");
    assert!(far.svg(200, 200).unwrap().len() < 2000);
    assert!(pattern(0, vec![]).svg(200, 200).is_err());
    assert!(pattern(2, vec![[2, 0]]).svg(200, 200).unwrap_err().to_string().contains("row 2, column 0"));
}
