//! A description as a Rust constant, for firmware's `build.rs`.

use haarline::Rectification;

use crate::{Description, Plan, RigError};

impl Description {
    /// The source of a constant: `PLAN`, a [`Plan`].
    ///
    /// # Errors
    /// As [`Description::plan`].
    pub fn to_rust(&self) -> Result<String, RigError> {
        let Plan {
            config,
            height,
            wiring,
            frame_rate_hz,
            exposure_lines,
            rectification,
            ring_rows,
            rig,
            camera_height_mm,
            pitch_deg,
            lowest_mm,
            highest_mm,
            sectors,
            reach,
        } = self.plan()?;
        let size = [config.width, height];
        let Rectification { ramp, columns, .. } = rectification;
        let lenses = self.lens_nodes()?.map_or_else(
            || "None".to_owned(),
            |nodes| {
                let [left, right] = nodes.map(|nodes| format!("LensTable::new({size:?}, &{nodes:?}).unwrap()"));
                format!("Some([{left}, {right}])")
            },
        );
        let correction = match self.correction_nodes() {
            Some((columns, nodes)) => format!("Correction::new({columns}, &{nodes:?})"),
            None => "None".to_owned(),
        };
        // What derives `Debug` and has public fields prints itself as an expression, if its types are in scope.
        Ok(format!(
            "/// The rig that this program was built for.\n\
             #[allow(unused_imports, clippy::all, clippy::pedantic, reason = \"written by a program\")]\n\
             pub const PLAN: haarline_rig::Plan = {{\n    \
             use haarline::setup::Reach;\n    \
             use haarline::wiring::{{First, Kind, Skew}};\n    \
             use haarline::{{Config, Correction, LensTable, Ramp, Rectification, Rig, Wiring}};\n    \
             haarline_rig::Plan {{\n        \
             config: {config:?},\n        \
             height: {height},\n        \
             wiring: Wiring {{ kind: Kind::{kind:?}, first: First::{first:?}, skew: Skew::{skew:?} }},\n        \
             frame_rate_hz: {frame_rate_hz},\n        \
             exposure_lines: {exposure_lines:?},\n        \
             rectification: Rectification {{ ramp: {ramp:?}, columns: {columns}, lenses: {lenses}, correction: {correction} }},\n        \
             ring_rows: {ring_rows},\n        \
             rig: Rig::new({focal}, {baseline}).unwrap().with_axes({axis:?}, {doffs}),\n        \
             camera_height_mm: {camera_height_mm},\n        \
             pitch_deg: {pitch_deg:?},\n        \
             lowest_mm: {lowest_mm},\n        \
             highest_mm: {highest_mm},\n        \
             sectors: {sectors},\n        \
             reach: {reach:?},\n    \
             }}\n}};\n",
            kind = wiring.kind,
            first = wiring.first,
            skew = wiring.skew,
            focal = rig.focal_px_q8(),
            baseline = rig.baseline_um(),
            axis = self.principal.iter().any(Option::is_some).then(|| rig.axis_q8([config.width, height])),
            doffs = rig.doffs_q8(),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    #[test]
    fn the_source_holds_the_plans_figures() {
        let description = Description::parse(&template()).unwrap();
        let (source, plan) = (description.to_rust().unwrap(), description.plan().unwrap());
        let wanted = [
            format!("config: {:?},", plan.config),
            format!("ramp: {:?},", plan.rectification.ramp),
            format!("reach: {:?},", plan.reach),
            "rig: Rig::new(51200, 60000).unwrap().with_axes(None, 0),".to_owned(),
            "kind: Kind::PixelInterleaved, first: First::Left, skew: Skew::None".to_owned(),
            "frame_rate_hz: 5,".to_owned(),
            "exposure_lines: None,".to_owned(),
            "pitch_deg: 0.0,".to_owned(),
            "sectors: 17,".to_owned(),
        ];
        let bent = template()
            + "left_camera = [200, 200, 160, 120]\nright_camera = [200, 200, 160, 120]\ndisparity_correction = [[0, 1]]\n";
        let bent = Description::parse(&bent).unwrap().to_rust().unwrap();
        assert!(
            bent.contains("lenses: Some([LensTable::new([320, 240], &[[")
                && bent.contains("Correction::new(2, &[0, 256])")
        );
        for words in wanted {
            assert!(source.contains(&words), "no {words} in {source}");
        }
    }
}
