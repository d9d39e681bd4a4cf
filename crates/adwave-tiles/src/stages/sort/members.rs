//! The rule by which records take part, once all of them are sorted.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use adwave::Progress;
use adwave::shape::KnownRange;

use crate::error::TilesError;
use crate::index::blocks::BlockTableBuilder;
use crate::layout::{MemberRule, RecordLayout, SUSPECT};

/// Bytes of a read buffer.
const BUFFER_BYTES: usize = 1 << 20;

/// Number of bits of a value that one pass over the records decides.
const DIGIT_BITS: u32 = 16;
const N_DIGITS: usize = 1 << DIGIT_BITS;

/// The sorted records in their file.
pub(super) struct SortedRecords<'a> {
    pub(super) path: &'a Path,
    pub(super) layout: RecordLayout,
    pub(super) progress: Progress<'a>,
}

impl SortedRecords<'_> {
    fn visit(&self, mut visit: impl FnMut(&[u8])) -> Result<(), TilesError> {
        let file = File::open(self.path).map_err(TilesError::io(self.path))?;
        let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
        let mut record = vec![0; self.layout.record_bytes()];
        let n = file.get_ref().metadata().map_err(TilesError::io(self.path))?.len() / record.len() as u64;
        for i in 0..n {
            if i % (1 << 20) == 0 {
                self.progress.check()?;
            }
            file.read_exact(&mut record).map_err(TilesError::io(self.path))?;
            visit(&record);
        }
        Ok(())
    }

    /// The block table of the records by their final rule; `builder` has the table by the first rule, which leaves out
    /// flagged points and knows no placeholders.
    pub(super) fn final_table(
        &self,
        mut builder: BlockTableBuilder,
    ) -> Result<BlockTableBuilder, TilesError> {
        let mut rule = builder.rule;
        // If all points of a file are flagged, they are meant to be processed.
        if builder.n_vertices == 0 && builder.outsiders.flagged > 0 {
            rule.includes_flagged = true;
            builder = self.build(rule)?;
        }
        if builder.n_suspects > 0 {
            rule.known = self.known_range(rule)?;
            if rule.known.is_some() {
                builder = self.build(rule)?;
            }
        }
        Ok(builder)
    }

    fn build(&self, rule: MemberRule) -> Result<BlockTableBuilder, TilesError> {
        let mut builder = BlockTableBuilder::new(self.layout, rule);
        self.visit(|record| builder.push(record))?;
        Ok(builder)
    }

    /// Calls `visit` with the position of each vertex that takes part and is no suspect.
    fn visit_known(&self, rule: MemberRule, mut visit: impl FnMut([f64; 3])) -> Result<(), TilesError> {
        let mut last = Vec::new();
        self.visit(|record| {
            let position = &record[..self.layout.position_bytes()];
            let is_known = rule.takes_part(&self.layout, record) && self.layout.marks(record) & SUSPECT == 0;
            if is_known && last != position {
                last.clear();
                last.extend_from_slice(position);
                visit(self.layout.model_position(record));
            }
        })
    }

    /// Range of the known coordinates; `None` for too few vertices. The values of a rank are found digit by digit.
    fn known_range(&self, rule: MemberRule) -> Result<Option<KnownRange>, TilesError> {
        let mut n = 0;
        self.visit_known(rule, |_| n += 1)?;
        if n < KnownRange::MIN_KNOWN {
            return Ok(None);
        }
        let [low, high] = KnownRange::ranks(n);
        let mut searches: Vec<RankSearch> = (0..3)
            .flat_map(|axis| [low, high].map(|rank| RankSearch { axis, rank: rank as u64, prefix: 0 }))
            .collect();
        for pass in 0..u64::BITS / DIGIT_BITS {
            let shift = u64::BITS - DIGIT_BITS * (pass + 1);
            let mut counts = vec![0_u64; searches.len() * N_DIGITS];
            self.visit_known(rule, |p| {
                for (search, counts) in searches.iter().zip(counts.chunks_exact_mut(N_DIGITS)) {
                    let key = sort_key(p[search.axis]);
                    if key.checked_shr(shift + DIGIT_BITS).unwrap_or(0) == search.prefix {
                        counts[(key >> shift) as usize % N_DIGITS] += 1;
                    }
                }
            })?;
            for (search, counts) in searches.iter_mut().zip(counts.chunks_exact(N_DIGITS)) {
                search.descend(counts);
            }
        }
        let value = |k: usize| value_of_key(searches[k].prefix);
        let (low, high) = ([0, 2, 4].map(value), [1, 3, 5].map(value));
        Ok(Some(KnownRange { low, high }))
    }
}

/// Search for the value of a rank among those that begin with `prefix`.
struct RankSearch {
    axis: usize,
    rank: u64,
    prefix: u64,
}

impl RankSearch {
    /// Extends the prefix by the next digit, by the numbers of values with each digit.
    fn descend(&mut self, counts: &[u64]) {
        for (digit, count) in counts.iter().enumerate() {
            if self.rank < *count {
                self.prefix = self.prefix << DIGIT_BITS | digit as u64;
                return;
            }
            self.rank -= count;
        }
    }
}

/// Key in the order of finite numbers.
fn sort_key(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

fn value_of_key(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_in_the_order_of_the_numbers() {
        let numbers = [-1e300, -2.5, -1e-300, 0.0, 1e-300, 2.5, 1e300];
        assert!(numbers.windows(2).all(|pair| sort_key(pair[0]) < sort_key(pair[1])));
        assert!(numbers.iter().all(|x| value_of_key(sort_key(*x)) == *x));
    }
}
