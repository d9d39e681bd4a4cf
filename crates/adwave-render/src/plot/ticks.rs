//! Formatting of tick labels.

/// Formats a tick of an axis of length `span`: with four digits or as many as the span needs, and with a power of ten
/// if the value is far from 1.
pub(super) fn number(value: f64, span: f64) -> String {
    let size = value.abs();
    // Rounding remainder of adding up steps to 0.
    if size < 1e-9 * span || size == 0.0 {
        return "0".to_owned();
    }
    let place = size.log10().floor();
    // Digits up to a hundredth of the span, at most all that a number has.
    let needed = (place - span.log10().floor() + 3.0).clamp(3.0, 16.0) as usize;
    if (1e-3..1e5).contains(&size) || (needed > 4 && (1e-3..1e15).contains(&size)) {
        let decimals = (needed.max(4) as i32 - 1 - place as i32).max(0) as usize;
        return strip_zeros(&format!("{value:.decimals$}")).to_owned();
    }
    let text = format!("{value:.0$e}", needed - 1);
    match text.split_once('e') {
        Some((mantissa, power)) => format!("{}e{power}", strip_zeros(mantissa)),
        None => text,
    }
}

/// Strips trailing zeros after the decimal point.
fn strip_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn ticks_keep_the_digits_that_tell_them_apart() {
        let shown =
            [(0.0125, 0.1), (2.5e-15, 1e-14), (-1e-15, 1e-14), (1e-17, 1.0), (12500.0, 1e5), (1e6, 1e6)]
                .map(|(value, span)| number(value, span));
        assert_eq!(shown, ["0.0125", "2.5e-15", "-1e-15", "0", "12500", "1e6"]);
        assert_eq!([1e6, 1e6 + 0.2].map(|value| number(value, 1.0)), ["1000000", "1000000.2"]);
    }
}
