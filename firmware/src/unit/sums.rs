//! What tables say, in a few sums: whether the ones in use still say what they said when they were
//! accepted.
//!
//! The work is cut into steps. Each block of cells is one of them, as it is read through the
//! tables. The last step is everything else: settings and what follows from them, range, gains, and
//! the answers of the tables to a warm-up, by thermal halves of its own. With one channel a step takes
//! some 25,000 instructions at most.

use heapless::Vec;
use tempco::{MAX_AXES, Table, Terms, Thermal};
use tempco_image::CRC;

use super::{IMAGE_LEN, UnitTables, UnitThermal};

/// Coefficients of an axis in a cell that a step takes: 4088 bytes, in which a CRC finds all errors of
/// up to 5 bits.
const BLOCK: usize = 4092 / size_of::<Terms>();

/// The most steps: blocks of the longest image, which end with each channel, and the last step.
const MAX_STEPS: usize = IMAGE_LEN / (BLOCK * size_of::<Terms>()) + MAX_AXES + 1;

/// Intervals of the warm-up, from one end of the range to the other.
const INTERVALS: u8 = 16;

/// Length of one \[s\]. The temperature rises by 12 degC/min where the range has 96 degC.
const INTERVAL_S: f32 = 30.0;

/// A sum for each step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sums(Vec<u32, MAX_STEPS>);

impl Sums {
    /// The sums of tables; none where there are too many of them, which no image has.
    pub fn of<const C: usize, const A: usize>(tables: &UnitTables<'_, C, A>) -> Option<Self> {
        let mut sums = Vec::new();
        for step in 0..=blocks(tables).count() {
            sums.push(sum(tables, step)?).ok()?;
        }
        Some(Self(sums))
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.0.len()
    }

    /// Whether tables still say what they did, as far as a step goes.
    pub fn hold<const C: usize, const A: usize>(
        &self,
        tables: &UnitTables<'_, C, A>,
        step: usize,
    ) -> bool {
        let known = self.0.get(step);
        known.is_some_and(|known| sum(tables, step) == Some(*known))
    }
}

/// The cells of all channels, in blocks.
fn blocks<'t, const C: usize, const A: usize>(
    tables: &UnitTables<'t, C, A>,
) -> impl Iterator<Item = &'t [Terms]> {
    tables
        .iter()
        .flat_map(|table| table.cells().as_flattened().chunks(BLOCK))
}

/// The sum of a step. None where the numbers that follow from the settings do not.
#[inline(never)]
fn sum<const C: usize, const A: usize>(tables: &UnitTables<'_, C, A>, step: usize) -> Option<u32> {
    let mut sum = Sum(CRC.digest());
    match blocks(tables).nth(step) {
        Some(block) => block.iter().for_each(|terms| sum.add(&terms.to_array())),
        None => {
            for table in tables {
                sum.add_rest(table)?;
            }
            sum.add_answers(tables);
        }
    }
    Some(sum.0.finalize())
}

/// A CRC of numbers.
struct Sum(crc::Digest<'static, u32>);

impl Sum {
    #[inline(never)]
    fn add(&mut self, numbers: &[f32]) {
        for number in numbers {
            self.0.update(&number.to_bits().to_le_bytes());
        }
    }

    /// What a table has besides its cells.
    fn add_rest<const A: usize>(&mut self, table: &Table<'_, A>) -> Option<()> {
        let thermal = table.thermal();
        let again = Thermal::new(*thermal.settings()).ok();
        again.filter(|again| again == thermal)?;
        self.add(&thermal.settings().to_array());
        self.add(&[
            table.first_edge_c(),
            table.cells_per_c(),
            table.t_min_c(),
            table.t_max_c(),
        ]);
        self.add(table.play_gains().as_flattened());
        Some(())
    }

    /// The biases of a warm-up.
    fn add_answers<const C: usize, const A: usize>(&mut self, tables: &UnitTables<'_, C, A>) {
        let mut halves = UnitThermal::new(tables, 1);
        for number in 0..=INTERVALS {
            let share = f32::from(number) / f32::from(INTERVALS);
            let temp_c = |table: &Table<'_, A>| {
                table.t_min_c() + share * (table.t_max_c() - table.t_min_c())
            };
            for ramp in halves.update(INTERVAL_S, &tables.each_ref().map(temp_c)) {
                self.add(&ramp.end);
            }
        }
    }
}
