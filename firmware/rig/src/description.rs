//! A rig description, read and checked.

use haarline::obstacle::MAX_SECTORS;
use haarline::setup::Reach;
use haarline::wiring::{First, Kind, Skew};
use haarline::{Config, Ramp, Rectification, Rig, Setup, Wiring};

use crate::field::Values;
use crate::{CameraModel, Lens, Plan, RigError};

/// Widest view, degrees: beyond, no lens is rectified to a plane.
const MAX_VIEW_DEG: f64 = 150.0;
/// Greatest distance that a message can tell, cm.
const MAX_CM: f64 = 65_533.0;

/// A pair of cameras and how it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// How the two cameras share the port.
    pub wiring: Wiring,
    /// Columns of one view, px.
    pub width: u16,
    /// Rows of one view, px.
    pub height: u16,
    /// Frames a second that a board lets the cameras take.
    pub frame_rate_hz: u16,
    /// Integration time that a board sets, lines; 0: the first camera's own control, copied to the second.
    pub exposure_lines: u16,
    /// Row offset of the right view in its middle column, px.
    pub row_offset: f64,
    /// Roll of the right camera, degrees; positive where points to the right lie lower.
    pub roll_deg: f64,
    /// How much higher than the left view the right one is, percent.
    pub scale_percent: f64,
    /// Whole columns by which the right view shows everything too far right.
    pub column_offset: i16,
    /// Focal length, px.
    pub focal_px: f64,
    /// Column and row of the left camera's axis, px, where they are known.
    pub principal: [Option<f64>; 2],
    /// Column of the right camera's axis less that of the left one, px.
    pub doffs: f64,
    /// Distance of the cameras, mm.
    pub baseline_mm: f64,
    /// Least disparity searched, px.
    pub min_disparity: i16,
    /// Number of disparities searched.
    pub num_disparities: u16,
    /// Height of the cameras over the ground, mm.
    pub camera_height_mm: i32,
    /// Pitch of the cameras, degrees; upwards is positive.
    pub pitch_deg: f64,
    /// Least height over the ground that is in the way, mm.
    pub lowest_mm: i32,
    /// Greatest height over the ground that is in the way, mm.
    pub highest_mm: i32,
    /// The left and the right camera before rectification, where their lenses are known.
    pub cameras: Option<[CameraModel; 2]>,
    /// What is added to disparities, px: rows of nodes at even distances; none or as many in each.
    pub correction: Vec<Vec<f64>>,
    /// Angle of a sector, degrees.
    pub sector_deg: u8,
}

impl Description {
    /// Reads the text of a `rig.toml`.
    ///
    /// # Errors
    /// If it is no TOML, has an unknown field, or one that is missing or out of its range, or fields that do
    /// not go together.
    pub fn parse(text: &str) -> Result<Self, RigError> {
        let values = Values::parse(text)?;
        let (kind, first, skew) = (values.word("wiring"), values.word("first"), values.word("skew"));
        let wiring = Wiring {
            kind: Kind::from_name(kind).ok_or_else(|| format!("wiring = {kind:?}: no such wiring"))?,
            first: First::from_name(first).unwrap_or_default(),
            skew: Skew::from_name(skew).unwrap_or_default(),
        };
        let description = Self {
            wiring,
            width: values.whole("width"),
            height: values.whole("height"),
            frame_rate_hz: values.whole("frame_rate_hz"),
            exposure_lines: values.whole("exposure_lines"),
            row_offset: values.real("row_offset"),
            roll_deg: values.real("roll_deg"),
            scale_percent: values.real("scale_percent"),
            column_offset: values.whole("column_offset"),
            focal_px: values.real("focal_px"),
            principal: ["cx", "cy"].map(|name| values.try_real(name)),
            doffs: values.real("doffs"),
            baseline_mm: values.real("baseline_mm"),
            min_disparity: values.whole("min_disparity"),
            num_disparities: values.whole("num_disparities"),
            camera_height_mm: values.whole("camera_height_mm"),
            pitch_deg: values.real("pitch_deg"),
            lowest_mm: values.whole("lowest_mm"),
            highest_mm: values.whole("highest_mm"),
            cameras: cameras(&values)?,
            correction: values.rows("disparity_correction"),
            sector_deg: values.whole("sector_deg"),
        };
        description.check()?;
        Ok(description)
    }

    /// Checks what several fields must fulfil together.
    ///
    /// # Errors
    /// Names the fields.
    pub fn check(&self) -> Result<(), RigError> {
        let Self { width, focal_px, lowest_mm, highest_mm, sector_deg, .. } = *self;
        let refuse = |words: String| Err(RigError::from(words));
        if self.wiring.skew != Skew::None && self.wiring.kind != Kind::PixelInterleaved {
            let skew = self.wiring.skew.name();
            return refuse(format!("skew = {skew:?}: is for wiring = \"pixel\" only, no other one has a skew"));
        }
        if self.num_disparities > width {
            let num = self.num_disparities;
            return refuse(format!("num_disparities = {num}: must not exceed the width, {width} px"));
        }
        if lowest_mm >= highest_mm {
            return refuse(format!("lowest_mm = {lowest_mm}: must be under highest_mm, {highest_mm} mm"));
        }
        if f64::from(self.max_disparity()) + self.doffs < 1.0 {
            let (min, max) = (self.min_disparity, self.max_disparity());
            return refuse(format!(
                "min_disparity = {min}, num_disparities = {}: {min} to {max} px holds no finite distance; must reach 1 px",
                self.num_disparities
            ));
        }
        if let Some(camera) =
            self.cameras.iter().flatten().find(|camera| camera.intrinsics[..2].iter().any(|&f| f < 10.0))
        {
            let [fx, fy, ..] = camera.intrinsics;
            return refuse(format!(
                "left_camera, right_camera: focal lengths of {fx} and {fy} px; must be 10 px or more"
            ));
        }
        let view = self.view_deg()[0];
        if view > MAX_VIEW_DEG {
            return refuse(format!(
                "focal_px = {focal_px}: with width = {width} px the view would be {view:.0} degrees wide; must be {:.0} px or more",
                (f64::from(width) / 2.0 / (MAX_VIEW_DEG / 2.0).to_radians().tan()).ceil()
            ));
        }
        let sectors = self.sector_count();
        if sectors > MAX_SECTORS {
            return refuse(format!(
                "sector_deg = {sector_deg}: makes {sectors} sectors of a view of {view:.0} degrees, and there may be {MAX_SECTORS}; must be {:.0} or more",
                (view / 71.0).ceil()
            ));
        }
        Ok(())
    }

    /// Width of a row and range of the search.
    #[must_use]
    pub const fn config(&self) -> Config {
        Config { width: self.width, min_disparity: self.min_disparity, num_disparities: self.num_disparities }
    }

    /// Where the right view has the left one's rows.
    #[must_use]
    pub fn ramp(&self) -> Ramp {
        let roll = self.roll_deg.to_radians();
        Ramp {
            rows_q16: fixed_q16(self.row_offset),
            roll_q16: fixed_q16(roll.tan()),
            // A rolled view is sheared by rows alone, in a column of which it is higher by the cosine.
            scale_q16: fixed_q16((1.0 + self.scale_percent / 100.0) / roll.cos() - 1.0),
        }
    }

    /// What is put right of the views and of disparities. Offsets, roll and scale are part of the lens tables where there are some.
    ///
    /// # Errors
    /// As [`Description::lens_nodes`].
    pub fn rectification(&self) -> Result<Rectification, RigError> {
        let (lenses, correction) = (self.lens_tables()?, self.correction_table());
        Ok(match lenses {
            Some(_) => Rectification { lenses, correction, ..Rectification::default() },
            None => Rectification { ramp: self.ramp(), columns: self.column_offset, lenses, correction },
        })
    }

    /// The middle of the left camera's view, px: its axis where it is known, else the middle of the picture.
    #[must_use]
    pub fn middle(&self) -> [f64; 2] {
        let [cx, cy] = self.principal;
        [cx.unwrap_or((f64::from(self.width) - 1.0) / 2.0), cy.unwrap_or((f64::from(self.height) - 1.0) / 2.0)]
    }

    /// Greatest whole disparity searched, px.
    #[must_use]
    pub fn max_disparity(&self) -> i32 {
        i32::from(self.min_disparity) + i32::from(self.num_disparities) - 1
    }

    /// Angles that one view spans across and down, degrees.
    #[must_use]
    pub fn view_deg(&self) -> [f64; 2] {
        [self.width, self.height].map(|px| 2.0 * (f64::from(px) / 2.0 / self.focal_px).atan().to_degrees())
    }

    /// How many sectors cover the view, the middle one straight ahead.
    #[must_use]
    pub fn sector_count(&self) -> usize {
        let beside = (self.view_deg()[0] / 2.0 / f64::from(self.sector_deg) - 0.5).ceil().max(0.0);
        (1..).step_by(2).find(|&count| f64::from(count / 2) >= beside).map_or(1, |count: u16| count.into())
    }

    fn first_deg(&self) -> i16 {
        let beside = i16::try_from(self.sector_count() / 2).unwrap_or(0);
        -beside * i16::from(self.sector_deg)
    }

    /// Depth of a disparity with `doffs` added, mm.
    #[must_use]
    pub fn depth_mm(&self, disparity_px: f64) -> f64 {
        self.focal_px * self.baseline_mm / disparity_px
    }

    /// Least and greatest finite depth that whole disparities of the search have, mm.
    #[must_use]
    pub fn depths_mm(&self) -> [f64; 2] {
        let [least, most] = [i32::from(self.min_disparity), self.max_disparity()].map(|px| f64::from(px) + self.doffs);
        [most, least.max(1.0)].map(|px| self.depth_mm(px))
    }

    /// The figures as a chip takes them.
    ///
    /// # Errors
    /// If the fields do not go together.
    pub fn plan(&self) -> Result<Plan, RigError> {
        self.check()?;
        let rig = Rig::new(steps(self.focal_px, 256.0), steps(self.baseline_mm, 1000.0));
        let rig = rig.ok_or_else(|| RigError::from("focal_px, baseline_mm: must be positive".to_owned()))?;
        let rectification = self.rectification()?;
        let is_known = self.principal.iter().any(Option::is_some);
        let rig = rig.with_axes(is_known.then(|| self.middle().map(fixed_q8)), fixed_q8(self.doffs));
        Ok(Plan {
            config: self.config(),
            height: self.height,
            wiring: self.wiring,
            frame_rate_hz: self.frame_rate_hz,
            exposure_lines: (self.exposure_lines > 0).then_some(self.exposure_lines),
            rectification,
            ring_rows: rectification.rows_needed([self.width, self.height]),
            rig,
            camera_height_mm: self.camera_height_mm,
            pitch_deg: narrow(self.pitch_deg),
            lowest_mm: self.lowest_mm,
            highest_mm: self.highest_mm,
            sectors: self.sector_count(),
            reach: self.reach(),
        })
    }

    /// What the core works with. `SECTORS` is the capacity, [`Description::sector_count`] or more.
    ///
    /// # Errors
    /// If the fields do not go together, or there are more sectors than `SECTORS`.
    pub fn setup<const SECTORS: usize>(&self) -> Result<Setup<SECTORS>, RigError> {
        let too_many = || format!("sector_deg: makes {} sectors, and there is room for {SECTORS}", self.sector_count());
        self.plan()?.setup().ok_or_else(|| too_many().into())
    }

    fn reach(&self) -> Reach {
        let cm = |mm: f64| to_u16((mm / 10.0).clamp(1.0, MAX_CM));
        let [nearest, farthest] = self.depths_mm().map(cm);
        Reach { sector_deg: self.sector_deg, first_deg: self.first_deg(), nearest_cm: nearest, farthest_cm: farthest }
    }
}

/// Both cameras before rectification, if they are told.
fn cameras(values: &Values) -> Result<Option<[CameraModel; 2]>, RigError> {
    let camera = |side: &str| -> Result<Option<CameraModel>, RigError> {
        let list = |what: &str| values.list(&format!("{side}_{what}"));
        let (Some(intrinsics), bent, turn) = (list("camera"), list("lens"), list("turn")) else {
            return match list("lens").or(list("turn")) {
                Some(_) => Err(format!("{side}_camera is missing: its lens and turn are told").into()),
                None => Ok(None),
            };
        };
        let model = values.word("lens");
        let bent = bent.unwrap_or_default();
        let mut lens = [0.0; 8];
        lens.iter_mut().zip(&bent).for_each(|(place, &value)| *place = value);
        let [k1, k2, k3, k4, ..] = lens;
        if model == "equidistant" && bent.len() != 4 {
            return Err(format!("{side}_lens: has {} numbers; lens = \"equidistant\" has 4", bent.len()).into());
        }
        let lens = if model == "equidistant" { Lens::Equidistant([k1, k2, k3, k4]) } else { Lens::Radial(lens) };
        let first = |values: Vec<f64>| values.try_into().unwrap_or([0.0; 3]);
        let intrinsics = intrinsics.try_into().unwrap_or([0.0; 4]);
        Ok(Some(CameraModel { intrinsics, lens, turn: turn.map_or([0.0; 3], first) }))
    };
    match (camera("left")?, camera("right")?) {
        (Some(left), Some(right)) => Ok(Some([left, right])),
        (None, None) => Ok(None),
        (left, _) => {
            let missing = if left.is_none() { "left_camera" } else { "right_camera" };
            Err(format!("{missing} is missing: lenses are told of both cameras or of none").into())
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "fields are in range")]
fn fixed_q8(value: f64) -> i32 {
    (value * 256.0).round() as i32
}

#[expect(clippy::cast_possible_truncation, reason = "fields are in range")]
fn fixed_q16(value: f64) -> i32 {
    (value * 65_536.0).round() as i32
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped by the caller")]
fn to_u16(value: f64) -> u16 {
    value.floor() as u16
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "fields are in range")]
fn steps(value: f64, scale: f64) -> u32 {
    (value * scale).round() as u32
}

#[expect(clippy::cast_possible_truncation, reason = "an angle, of which the last digits do not matter")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;
    use haarline::obstacle::{Obstacles, Settings};

    /// The template with some lines replaced.
    fn with(changes: &[(&str, &str)]) -> String {
        let line = |line: &str| {
            let key = line.trim_start_matches("# ").split(" =").next().unwrap_or_default();
            let change = changes.iter().find(|(name, _)| *name == key);
            change.map_or_else(|| line.to_owned(), |(name, value)| format!("{name} = {value}"))
        };
        template().lines().map(line).collect::<Vec<_>>().join("\n")
    }

    fn parse(changes: &[(&str, &str)]) -> Result<Description, String> {
        Description::parse(&with(changes)).map_err(|error| error.to_string())
    }

    #[test]
    fn the_template_is_a_valid_description() {
        let description = parse(&[]).unwrap();
        assert_eq!(description.wiring, Wiring::new(Kind::PixelInterleaved, First::Left));
        assert_eq!((description.width, description.height, description.num_disparities), (320, 240, 48));
        assert_eq!((description.focal_px, description.baseline_mm), (200.0, 60.0));
    }

    #[test]
    fn lenses_are_told_of_both_cameras_or_of_none() {
        let camera = ("left_camera", "[200.0, 200.0, 160.0, 120.0]");
        let error = parse(&[camera]).unwrap_err();
        assert_eq!(error, "right_camera is missing: lenses are told of both cameras or of none");
        let error = parse(&[("right_turn", "[0.0, 0.0, 0.0]")]).unwrap_err();
        assert_eq!(error, "right_camera is missing: its lens and turn are told");
        let both = [camera, ("right_camera", "[200.0, 200.0, 160.0, 120.0]")];
        assert_eq!(parse(&both).unwrap().cameras.unwrap()[1].lens, Lens::Radial([0.0; 8]));
        let error = parse(&[both[0], both[1], ("lens", "\"equidistant\"")]).unwrap_err();
        assert_eq!(error, "left_lens: has 0 numbers; lens = \"equidistant\" has 4");
        let corrected = parse(&[("disparity_correction", "[[0.5, -0.25, 1]]")]).unwrap();
        assert_eq!(corrected.correction_table().unwrap().nodes(), [128, -64, 256]);
        // A roll alone: tan 1 degree by half of 239 rows above, as much less below. A fitted correction has that in it.
        let rolled = parse(&[("roll_deg", "1.0")]).unwrap();
        assert_eq!(rolled.correction_table().unwrap().nodes(), [534, 534, -534, -534]);
        let fitted = parse(&[("roll_deg", "1.0"), ("disparity_correction", "[[0.5, -0.25, 1]]")]).unwrap();
        assert_eq!(fitted.correction_table().unwrap().nodes(), [128, -64, 256]);
        assert_eq!(parse(&[("roll_deg", "0.1")]).unwrap().correction_table(), None);
    }

    #[test]
    fn every_field_out_of_its_range_is_told_with_range_and_unit() {
        let cases = [
            (
                "wiring",
                "\"frame\"",
                "one of \"pixel\", \"line\", \"side-by-side\", \"nibble\", \"pairs16\", \"pairs14\"",
            ),
            ("first", "\"middle\"", "one of \"left\", \"right\""),
            ("skew", "1", "one of \"none\", \"left\", \"right\""),
            ("width", "31", "a whole number, 32 to 1280 px"),
            ("height", "4097", "a whole number, 8 to 4096 px"),
            ("frame_rate_hz", "0", "a whole number, 1 to 120 1/s"),
            ("exposure_lines", "-1", "a whole number, 0 to 65535 lines"),
            ("row_offset", "-17", "-16 to 16 px"),
            ("roll_deg", "5.5", "-5 to 5 degrees"),
            ("scale_percent", "-6", "-5 to 5 percent"),
            ("column_offset", "129", "a whole number, -128 to 128 px"),
            ("focal_px", "nan", "10 to 10000 px"),
            ("cx", "nan", "-10000 to 10000 px"),
            ("cy", "\"middle\"", "-10000 to 10000 px"),
            ("doffs", "300", "-256 to 256 px"),
            ("baseline_mm", "0", "1 to 10000 mm"),
            ("min_disparity", "1.5", "a whole number, -128 to 128 px"),
            ("num_disparities", "0", "a whole number, 1 to 256 px"),
            ("camera_height_mm", "-1", "a whole number, 0 to 10000 mm"),
            ("pitch_deg", "61", "-60 to 60 degrees"),
            ("lowest_mm", "\"0\"", "a whole number, -10000 to 10000 mm"),
            ("highest_mm", "10001", "a whole number, -10000 to 10000 mm"),
            ("lens", "\"fisheye62\"", "one of \"radtan\", \"equidistant\""),
            ("left_camera", "[1.0, 2.0]", "[4 numbers], each -100000 to 100000 px"),
            ("left_lens", "[0.1]", "[0, 2, 4, 5, 8 numbers], each -1000000 to 1000000"),
            ("left_turn", "[0.0, nan, 0.0]", "[3 numbers], each -2 to 2 radians"),
            ("right_camera", "3", "[4 numbers], each -100000 to 100000 px"),
            ("right_lens", "[10000000.0, 0.0]", "[0, 2, 4, 5, 8 numbers], each -1000000 to 1000000"),
            ("right_turn", "[]", "[3 numbers], each -2 to 2 radians"),
            (
                "disparity_correction",
                "[[0.0, 1.0], [2.0]]",
                "[[...], ...], 1 to 25 rows of 2 to 33 numbers each, -64 to 64 px",
            ),
            ("sector_deg", "0", "a whole number, 1 to 15 degrees"),
        ];
        assert_eq!(cases.len(), crate::field::FIELDS.len());
        for (name, value, allowed) in cases {
            assert_eq!(parse(&[(name, value)]), Err(format!("{name} = {value}: must be {allowed}")));
        }
    }

    #[test]
    fn unknown_and_missing_fields_and_other_text_are_refused() {
        let told = |text: &str| Description::parse(text).unwrap_err().to_string();
        let unknown = told(&(template() + "focal_mm = 3\n"));
        assert!(unknown.starts_with("focal_mm: no such field; there are wiring, first, skew, width"), "{unknown}");
        let missing = told(&template().replace("baseline_mm =", "# "));
        assert_eq!(missing, "baseline_mm is missing: distance of the two cameras; 1 to 10000 mm");
        let text = told("wiring = \"line\"\nfocal_px == 3\n");
        assert!(text.starts_with("line 2: ") && !text.contains('\n'), "{text}");
        assert!(told("width = 3\nwidth = 4\n").starts_with("line 2: "));
    }

    #[test]
    fn what_may_be_left_out_has_the_templates_value() {
        let short: String = template()
            .lines()
            .filter(|line| {
                ![
                    "first",
                    "skew",
                    "frame_rate_hz",
                    "exposure_lines",
                    "row_offset",
                    "column_offset",
                    "min_disparity",
                    "sector_deg",
                ]
                .iter()
                .any(|name| line.starts_with(&format!("{name} =")))
            })
            .flat_map(|line| [line, "\n"])
            .collect();
        assert_eq!(Description::parse(&short), Description::parse(&template()));
    }

    #[test]
    fn fields_that_do_not_go_together_are_refused() {
        let cases: [(&[(&str, &str)], &str); 6] = [
            (&[("wiring", "\"line\""), ("skew", "\"left\"")], "wiring = \"pixel\" only"),
            (&[("width", "40")], "num_disparities = 48: must not exceed the width, 40 px"),
            (&[("lowest_mm", "500")], "must be under highest_mm, 500 mm"),
            (&[("min_disparity", "-48")], "must reach 1 px"),
            (&[("focal_px", "40")], "must be 43 px or more"),
            (&[("sector_deg", "1")], "must be 2 or more"),
        ];
        for (changes, words) in cases {
            let told = parse(changes).unwrap_err();
            assert!(told.contains(words), "{told}");
        }
    }

    #[test]
    fn sectors_cover_the_view_with_the_middle_one_ahead() {
        let description = parse(&[]).unwrap();
        let bearings: Vec<i16> = description.plan().unwrap().bearings_deg().collect();
        assert_eq!((bearings.len(), bearings[0], bearings[8], bearings[16]), (17, -40, 0, 40));
        let setup = description.setup::<72>().unwrap();
        assert_eq!((setup.sectors.count, setup.sectors.secant_q14[8]), (17, 1 << 14));
        assert_eq!(setup.sectors.left_q16[8], -setup.sectors.left_q16[9]);
        assert_eq!(setup.reach, Reach { sector_deg: 5, first_deg: -40, nearest_cm: 25, farthest_cm: 1200 });
        assert!(description.setup::<16>().is_err());
    }

    #[test]
    fn the_core_takes_every_description_at_its_limits() {
        let cases: [&[(&str, &str)]; 6] = [
            &[],
            &[("focal_px", "10000"), ("baseline_mm", "10000"), ("pitch_deg", "60"), ("height", "4096")],
            &[("focal_px", "43"), ("sector_deg", "15"), ("pitch_deg", "-60")],
            &[("focal_px", "43"), ("sector_deg", "3")],
            &[("camera_height_mm", "10000"), ("lowest_mm", "-10000"), ("highest_mm", "10000")],
            &[("width", "1280"), ("num_disparities", "256"), ("focal_px", "171.5"), ("baseline_mm", "1")],
        ];
        for changes in cases {
            let description = parse(changes).unwrap();
            let setup = description.setup::<72>().unwrap();
            let size = [setup.config.width, setup.height];
            let made = Obstacles::<72, { haarline::blocks_for(1280) }>::new(
                size,
                setup.rig,
                setup.mounting,
                setup.sectors,
                Settings::DEFAULT,
            );
            assert!(made.is_ok() && setup.config.check().is_ok(), "{changes:?}: {made:?}");
        }
    }
}
