//! Number formats of the vectors of a recurrence.

/// Number of entries whose products are summed before they are added to a row in single precision, so that rounding
/// grows with this number plus the number of groups instead of the number of entries.
pub(crate) const GROUP: usize = 8;

/// Number format of the vectors of a recurrence.
pub(crate) trait VectorNumber: Copy + Default + Send + Sync + std::fmt::Debug + 'static {
    /// True if the entries of a row are summed in groups of [`GROUP`].
    const IS_GROUPED: bool;

    /// The product `a·scale`, rounded; the scale is a power of 2, and 1 in double precision.
    fn rounded(a: f64, scale: f64) -> Self;

    fn to_f64(self) -> f64;

    fn times(self, factor: Self) -> Self;

    fn plus(self, other: Self) -> Self;

    fn minus(self, other: Self) -> Self;

    /// The sum `self·b + c`, rounded once if `FMA`.
    fn times_plus<const FMA: bool>(self, b: Self, c: Self) -> Self;
}

/// Implements [`VectorNumber`] for a primitive type.
macro_rules! number {
    ($type:ident, $is_grouped:literal, |$a:ident, $scale:ident| $rounded:expr) => {
        impl VectorNumber for $type {
            const IS_GROUPED: bool = $is_grouped;

            #[inline(always)]
            fn rounded($a: f64, $scale: f64) -> Self {
                $rounded
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }

            #[inline(always)]
            fn times(self, factor: Self) -> Self {
                self * factor
            }

            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self + other
            }

            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                self - other
            }

            #[inline(always)]
            fn times_plus<const FMA: bool>(self, b: Self, c: Self) -> Self {
                if FMA { self.mul_add(b, c) } else { self * b + c }
            }
        }
    };
}

number!(f64, false, |a, _scale| a);
number!(f32, true, |a, scale| (a * scale) as f32);
