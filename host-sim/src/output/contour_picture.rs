//! The contour preparation of an image as a picture: the paper's K(f).

use anyhow::{Result, ensure};
use haarline::contour::Contour;
use haarline::curvature::curvature;
use haarline::extremum::parabola;
use haarline::haar;

use crate::Frame;

/// Least mean step of a contour, grey levels.
const THRESHOLD: i32 = 2;
/// Share of the contours that are drawn in full white, the strongest ones.
const WHITE_SHARE: usize = 50;
/// Least mean step of a contour whose bends are marked, grey levels: fainter ones bend with the noise.
const BEND_THRESHOLD: i32 = 10;
/// Least bend of a contour over three rows that is marked, 1/16 px.
const LEAST_BEND: i32 = 32;
/// Of points nearer than this, px, in both directions, only the one that bends most is marked.
const BEND_DISTANCE: usize = 8;

/// Which contours are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContourPicture {
    /// Pixels on either side of an edge.
    pub half_support: usize,
    /// Contours along the columns, too: the lying ones, by logical OR.
    pub columns: bool,
    /// By the decimated transform without its approximation (eq. 1) instead of the sliding response.
    pub decimated: bool,
}

impl ContourPicture {
    /// The picture, as many pixels as the frame: contours bright on black, the brighter the stronger.
    ///
    /// A contour is an extremum of the response along its line, of a mean step of 2 grey levels or more.
    ///
    /// # Errors
    /// If the support is longer than a line, or no power of two where it must be one.
    pub fn draw(&self, frame: &Frame) -> Result<Vec<u8>> {
        let Self { half_support, columns, decimated } = *self;
        let (width, height) = (frame.width, frame.height);
        ensure!(half_support > 0, "--half-support 0: must be 1 px or more");
        ensure!(
            !decimated || half_support.is_power_of_two(),
            "--half-support {half_support}: the decimated transform has half-supports of 1, 2, 4, 8, 16, ... px"
        );
        let support = half_support.saturating_mul(2);
        let is_too_long = |pixels| support > pixels;
        ensure!(
            !is_too_long(width),
            "--half-support {half_support}: the wavelet is {support} px long, but the image only {width} px wide"
        );
        ensure!(
            !columns || !is_too_long(height),
            "--half-support {half_support}: the wavelet is {support} px long, but the image only {height} px high; \
             leave out --columns or take a smaller one"
        );
        let mut strengths = vec![0; width * height];
        for (line, out) in frame.luma.chunks(width).zip(strengths.chunks_mut(width)) {
            out.copy_from_slice(&self.contours(line));
        }
        for x in (0..width).filter(|_| columns) {
            let line: Vec<u8> = frame.luma.iter().skip(x).step_by(width).copied().collect();
            for (out, strength) in strengths.iter_mut().skip(x).step_by(width).zip(self.contours(&line)) {
                *out = strength.max(*out);
            }
        }
        Ok(shade(&strengths))
    }

    /// The pixels of maximum curvature (S2b), the sharpest first: where an upright contour bends by 2 px or
    /// more from the row two half-supports above to the row as many below, and more than any contour near it.
    #[must_use]
    pub fn bends(&self, frame: &Frame) -> Vec<usize> {
        let apart = 2 * self.half_support;
        let lines: Vec<Vec<Contour>> = frame.luma.chunks(frame.width).map(|line| self.points(line)).collect();
        let rows = lines.iter().zip(lines.iter().skip(apart)).zip(lines.iter().skip(2 * apart));
        let mut found = Vec::new();
        for (y, ((above, row), below)) in (apart..).zip(rows) {
            let bends = curvature(above, row, below, LEAST_BEND);
            found.extend(bends.map(|point| (point.bend.abs(), row[point.index].column as usize / 16, y)));
        }
        found.sort_unstable_by_key(|&(bend, x, y)| (-bend, y, x));
        let mut kept: Vec<(usize, usize)> = Vec::new();
        for (_, x, y) in found {
            if !kept.iter().any(|&(a, b)| a.abs_diff(x) < BEND_DISTANCE && b.abs_diff(y) < BEND_DISTANCE) {
                kept.push((x, y));
            }
        }
        kept.into_iter().map(|(x, y)| y * frame.width + x).collect()
    }

    /// The clear contours of a line with the fraction of their column.
    fn points(&self, line: &[u8]) -> Vec<Contour> {
        let mut responses = vec![0; line.len()];
        haar::sliding_response(line, self.half_support, &mut responses);
        let strengths = self.contours(line);
        let point = |x: usize| {
            let [before, here, after] = [x.checked_sub(1)?, x, x + 1].map(|x| responses.get(x).copied().unwrap_or(0));
            let sign = here.signum();
            let column = 16 * x as i32 + parabola(-before * sign, -here * sign, -after * sign);
            let response = here.clamp(i16::MIN.into(), i16::MAX.into());
            Some(Contour { column: i16::try_from(column).ok()?, response: response as i16 })
        };
        (0..line.len()).filter(|&x| strengths[x] >= 16 * BEND_THRESHOLD).filter_map(point).collect()
    }

    /// The mean steps of the contours of a line, grey levels in 1/16; 0 where there is none.
    fn contours(&self, line: &[u8]) -> Vec<i32> {
        let half = self.half_support;
        let (responses, distance) = if self.decimated {
            (decimated_response(line, half), 2 * half)
        } else {
            let mut responses = vec![0; line.len()];
            haar::sliding_response(line, half, &mut responses);
            (responses, 1)
        };
        let strength = |x: Option<usize>| x.and_then(|x| responses.get(x)).map_or(0, |response| response.abs());
        let is_contour = |x: usize| {
            let here = strength(Some(x));
            let is_strong = here >= THRESHOLD * half as i32;
            is_strong && here > strength(x.checked_sub(distance)) && here >= strength(Some(x + distance))
        };
        let step = |x| if is_contour(x) { 16 * strength(Some(x)) / half as i32 } else { 0 };
        (0..line.len()).map(step).collect()
    }
}

/// The response of the decimated transform in the unit of the sliding one: each pair's detail, times the
/// half-support, at the first pixel of the pair's second half.
fn decimated_response(line: &[u8], half_support: usize) -> Vec<i32> {
    let mut level: Vec<i16> = line.iter().map(|&v| v.into()).collect();
    let mut scale = 1;
    while scale < half_support {
        (level, _) = forward(&level);
        scale *= 2;
    }
    let (approximation, detail) = forward(&level);
    // With the approximation set to zero the inverse leaves the contours: f'.
    let mut contours = vec![0; level.len()];
    haar::inverse(&vec![0; approximation.len()], &detail, &mut contours);
    let mut response = vec![0; line.len()];
    for (pair, values) in contours.as_chunks::<2>().0.iter().enumerate() {
        if let Some(response) = response.get_mut((2 * pair + 1) * half_support) {
            *response = (i32::from(values[1]) - i32::from(values[0])) * half_support as i32;
        }
    }
    response
}

/// Approximation and detail of one level.
fn forward(line: &[i16]) -> (Vec<i16>, Vec<i16>) {
    let (mut approximation, mut detail) = (vec![0; line.len().div_ceil(2)], vec![0; line.len() / 2]);
    haar::forward(line, &mut approximation, &mut detail);
    (approximation, detail)
}

/// Grey levels of the contours' strengths: with the root of the strength, so that faint ones show, too.
fn shade(strengths: &[i32]) -> Vec<u8> {
    let mut sorted: Vec<i32> = strengths.iter().copied().filter(|&strength| strength > 0).collect();
    sorted.sort_unstable();
    let white = sorted.get(sorted.len().saturating_sub(1 + sorted.len() / WHITE_SHARE)).copied().unwrap_or(1);
    let grey = |strength: i32| (255.0 * (f64::from(strength) / f64::from(white)).sqrt().min(1.0)).round() as u8;
    strengths.iter().map(|&strength| grey(strength)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 32;

    /// Columns and rows of the bright pixels of a picture of a bright square from pixel 16 to 24.
    fn bright(half_support: usize, columns: bool, decimated: bool) -> Vec<(usize, usize)> {
        let is_inside = |i: usize| (16..24).contains(&(i % SIZE)) && (16..24).contains(&(i / SIZE));
        let luma = (0..SIZE * SIZE).map(|i| if is_inside(i) { 90 } else { 40 }).collect();
        let picture = ContourPicture { half_support, columns, decimated };
        let picture = picture.draw(&Frame::from_luma(SIZE, SIZE, luma)).unwrap();
        assert!(picture.iter().all(|&v| v == 0 || v == 255), "contours of one strength on black");
        (0..SIZE * SIZE).filter(|&i| picture[i] > 0).map(|i| (i % SIZE, i / SIZE)).collect()
    }

    #[test]
    fn a_square_has_its_sides_and_nothing_else() {
        let upright: Vec<(usize, usize)> = (16..24).flat_map(|y| [(16, y), (24, y)]).collect();
        for half_support in [1, 2, 3, 4] {
            assert_eq!(bright(half_support, false, false), upright, "half-support {half_support}");
            let both = bright(half_support, true, false);
            assert_eq!(both.len(), 2 * upright.len() - 1, "the first corner is in both");
            assert!(upright.iter().all(|&(x, y)| both.contains(&(x, y)) && both.contains(&(y, x))));
        }
    }

    #[test]
    fn the_decimated_transform_sees_the_edges_that_lie_within_its_pairs() {
        assert_eq!(bright(1, false, true), [], "both sides lie between pairs");
        let upright: Vec<(usize, usize)> = (16..24).flat_map(|y| [(8, y), (24, y)]).collect();
        assert!(bright(8, false, true).iter().all(|point| upright.contains(point)));
        assert!(bright(8, false, true).contains(&(24, 20)));
    }

    #[test]
    fn a_contour_is_marked_where_it_bends_and_a_straight_one_nowhere() {
        let roof = |y: usize| 12 + y.abs_diff(16) / 2;
        let draw = |edge: &dyn Fn(usize) -> usize| {
            let luma = (0..SIZE * SIZE).map(|i| if i % SIZE < edge(i / SIZE) { 40 } else { 90 }).collect();
            let picture = ContourPicture { half_support: 2, columns: false, decimated: false };
            picture.bends(&Frame::from_luma(SIZE, SIZE, luma))
        };
        let bends = draw(&roof);
        assert!(bends.contains(&(16 * SIZE + 12)), "{bends:?}");
        assert!(bends.iter().all(|i| (i / SIZE).abs_diff(16) <= 4), "{bends:?}");
        assert!(draw(&|y| 4 + y / 2).is_empty());
    }

    #[test]
    fn a_support_longer_than_a_line_is_refused_by_name() {
        let frame = Frame::from_luma(9, 5, vec![7; 45]);
        let draw = |half_support, columns, decimated| {
            ContourPicture { half_support, columns, decimated }.draw(&frame).map_err(|error| error.to_string())
        };
        assert_eq!(draw(4, false, false), Ok(vec![0; 45]));
        assert!(draw(5, false, false).unwrap_err().contains("9 px wide"));
        assert!(draw(3, true, false).unwrap_err().contains("5 px high"));
        assert!(draw(0, false, false).unwrap_err().contains("1 px or more"));
        assert!(draw(3, false, true).unwrap_err().contains("1, 2, 4, 8"));
        assert!(draw(usize::MAX, false, false).is_err());
    }
}
