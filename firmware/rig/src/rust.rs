//! A description as Rust constants, for firmware's `build.rs`.

use haarline::Setup;
use haarline::obstacle::MAX_SECTORS;

use crate::{Description, RigError};

impl Description {
    /// The source of two constants: `SECTORS`, the number of sectors, and `SETUP`, a
    /// [`haarline::Setup`] of as many.
    ///
    /// # Errors
    /// As [`Description::setup`].
    pub fn to_rust(&self) -> Result<String, RigError> {
        let Setup { config, height, wiring, offset, rig, mounting, sectors, reach } = self.setup::<MAX_SECTORS>()?;
        let used = |list: &[u32]| list.iter().take(sectors.count).map(u32::to_string).collect::<Vec<_>>().join(", ");
        let left = sectors.left_q16.iter().take(sectors.count).map(i32::to_string).collect::<Vec<_>>().join(", ");
        // What derives `Debug` and has public fields prints itself as an expression, if its types are in scope.
        Ok(format!(
            "/// Bearing sectors of the rig.\n\
             pub const SECTORS: usize = {count};\n\
             /// The rig that this program was built for.\n\
             pub const SETUP: haarline::Setup<SECTORS> = {{\n    \
             use haarline::obstacle::{{Mounting, Sectors}};\n    \
             use haarline::setup::Reach;\n    \
             use haarline::wiring::{{First, Kind, Skew}};\n    \
             use haarline::{{Config, Offset, Rig, Setup, Wiring}};\n    \
             Setup {{\n        \
             config: {config:?},\n        \
             height: {height},\n        \
             wiring: Wiring {{ kind: Kind::{kind:?}, first: First::{first:?}, skew: Skew::{skew:?} }},\n        \
             offset: {offset:?},\n        \
             rig: Rig::new({focal}, {baseline}).unwrap(),\n        \
             mounting: {mounting:?},\n        \
             sectors: Sectors {{ count: {count}, left_q16: [{left}], right_q16: {right}, secant_q14: [{secants}] }},\n        \
             reach: {reach:?},\n    \
             }}\n}};\n",
            count = sectors.count,
            kind = wiring.kind,
            first = wiring.first,
            skew = wiring.skew,
            focal = rig.focal_px_q8(),
            baseline = rig.baseline_um(),
            right = sectors.right_q16,
            secants = used(&sectors.secant_q14),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

    #[test]
    fn the_source_holds_the_setups_numbers() {
        let description = Description::parse(&template()).unwrap();
        let (source, setup) = (description.to_rust().unwrap(), description.setup::<17>().unwrap());
        let wanted = [
            "pub const SECTORS: usize = 17;".to_owned(),
            format!("config: {:?},", setup.config),
            format!("offset: {:?},", setup.offset),
            format!("mounting: {:?},", setup.mounting),
            format!("sectors: {:?},", setup.sectors),
            format!("reach: {:?},", setup.reach),
            "rig: Rig::new(51200, 60000).unwrap(),".to_owned(),
            "kind: Kind::PixelInterleaved, first: First::Left, skew: Skew::None".to_owned(),
        ];
        for words in wanted {
            assert!(source.contains(&words), "no {words} in {source}");
        }
    }
}
