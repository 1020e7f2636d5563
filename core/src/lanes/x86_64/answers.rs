//! Kernels of answers, eight cells at once.

use super::quad::Quad;
use super::smoothing::blend;
use crate::Disparity;
use crate::lanes::answer_rows::{PixelPair, PlanePairs, down_bits};
use crate::lanes::splat_half;

/// [`lay_planes`](crate::lanes::answer_rows::lay_planes) of as many fours of pairs as there are; the first pair that is left.
#[inline(always)]
pub(crate) fn lay_planes_by_fours<const HEIGHT: u32>(
    planes: &PlanePairs<'_>,
    pixels: &mut [PixelPair],
    downs: &mut [[i16; 2]],
) -> usize {
    let [above, here, below] = planes.values.map(|row| row.as_chunks::<4>().0);
    let sources = above.iter().zip(here).zip(below).zip(planes.slopes.as_chunks::<4>().0);
    let same = Quad::splat(planes.same);
    let bases = planes.bases.map(Quad::splat);
    let raised = Quad::splat(planes.raised);
    let mut done = 0;
    let results = pixels.as_chunks_mut::<4>().0.iter_mut().zip(downs.as_chunks_mut::<4>().0);
    for ((((above, here), below), slopes), (pixels, downs)) in sources.zip(results) {
        let [above, here, below, across] = [Quad::read(above), Quad::read(here), Quad::read(below), Quad::read(slopes)];
        let (here, down) = blend(same, here, above, below);
        let columns = columns(here, across, bases);
        for (quad, pixels) in pixels_of(columns).into_iter().zip(pixels) {
            quad.write(pixels);
        }
        let down = if down_bits(HEIGHT) == 6 { divided::<6>(down) } else { divided::<7>(down) };
        down.sub_halves(raised).write(downs);
        done += 4;
    }
    done
}

/// Disparities of the four columns of cells: of their middles, a quarter of the slope along the row between two columns.
#[inline(always)]
fn columns(here: Quad, across: Quad, bases: [Quad; 2]) -> [Quad; 4] {
    let middle = here.halves_down::<3>().add_halves(Quad::splat(splat_half(1))).halves_down::<1>();
    let [less, more] = bases.map(|base| middle.add_halves(base));
    let near = divided::<7>(across);
    let far = divided::<7>(across.add_halves(across).add_halves(across));
    [less.sub_halves(far), less.sub_halves(near), more.add_halves(near), more.add_halves(far)]
}

/// The columns pair by pair of cells.
#[inline(always)]
fn pixels_of([a, b, c, d]: [Quad; 4]) -> [Quad; 4] {
    let (left, right) = (a.halves_in_turn(b), c.halves_in_turn(d));
    let (more_left, more_right) = (a.upper_halves_in_turn(b), c.upper_halves_in_turn(d));
    [left.in_turn(right), left.upper_in_turn(right), more_left.in_turn(more_right), more_left.upper_in_turn(more_right)]
}

/// [`divided`](crate::lanes::answer_rows) of eight numbers.
#[inline(always)]
fn divided<const BITS: i32>(numbers: Quad) -> Quad {
    numbers.add_halves(Quad::splat(splat_half(0x8000 + (1 << (BITS - 1))))).halves_down::<BITS>()
}

/// [`write_moved`](crate::lanes::answer_rows::write_moved) of as many fours of pairs as there are; the first pair that is left.
#[inline(always)]
pub(crate) fn write_moved_by_fours<const TIMES: i32>(
    pixels: &[PixelPair],
    slopes: &[[i16; 2]],
    least: u32,
    out: &mut [[[Disparity; 4]; 2]],
) -> usize {
    let least = Quad::splat(least);
    let fours = pixels.as_chunks::<4>().0.iter().zip(slopes.as_chunks::<4>().0).zip(out.as_chunks_mut::<4>().0);
    let mut done = 0;
    for ((pixels, slopes), out) in fours {
        let downs = by_column(times::<TIMES>(Quad::read(slopes)));
        for ((pixels, down), out) in pixels.iter().zip(downs).zip(out) {
            Quad::read(pixels).add_halves(down).signed_max_halves(least).write(out);
        }
        done += 4;
    }
    done
}

/// So many times eight numbers: -3, -1, 1 or 3.
#[inline(always)]
fn times<const TIMES: i32>(numbers: Quad) -> Quad {
    const { assert!(matches!(TIMES, -3 | -1 | 1 | 3)) }
    let so_many = if TIMES.unsigned_abs() == 3 { numbers.add_halves(numbers).add_halves(numbers) } else { numbers };
    if TIMES < 0 { Quad::splat(0).sub_halves(so_many) } else { so_many }
}

/// What eight cells have, for each of their four columns, pair by pair.
#[inline(always)]
fn by_column(cells: Quad) -> [Quad; 4] {
    let [lower, upper] = [cells.halves_in_turn(cells), cells.upper_halves_in_turn(cells)];
    [lower.in_turn(lower), lower.upper_in_turn(lower), upper.in_turn(upper), upper.upper_in_turn(upper)]
}
