//! How two cameras share a port.

use anyhow::{Context, Result, ensure};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use haarline::Wiring;
use haarline::wiring::{First, Kind, Skew};
use haarline_rig::Description;

use crate::input::recording::Side;

/// How two cameras share a port.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct WiringArgs {
    /// In which order a raw dump has the pixels of the two cameras
    #[arg(long, value_name = "KIND", value_parser = by_name(Kind::ALL, Kind::name))]
    wiring: Option<Kind>,
    /// Which camera is first: in time, in the left half (in a recording's frames, too), on the low data
    /// lines [default: the rig's; of a raw dump without a rig: left]
    #[arg(long, value_enum, value_name = "CAMERA")]
    pub(in crate::command) first: Option<Side>,
    /// Whose pixels come one late; with --wiring pixel only [default: none]
    #[arg(long, value_name = "CAMERA", value_parser = by_name(Skew::ALL, Skew::name))]
    skew: Option<Skew>,
}

impl WiringArgs {
    /// The wiring, if one was told.
    pub(in crate::command) fn get(&self) -> Result<Option<Wiring>> {
        let Some(kind) = self.wiring else {
            ensure!(self.skew.is_none(), "--skew: is for raw dumps, with --wiring pixel");
            return Ok(None);
        };
        let skew = self.skew.unwrap_or_default();
        let name = skew.name();
        ensure!(
            kind == Kind::PixelInterleaved || skew == Skew::None,
            "--skew {name}: is for --wiring pixel only, no other one has a skew"
        );
        let first = self.first.map_or(First::Left, |side| match side {
            Side::Left => First::Left,
            Side::Right => First::Right,
        });
        Ok(Some(Wiring { kind, first, skew }))
    }

    /// The first camera, the rig's where nothing was told.
    pub(in crate::command) fn first_with(&self, rig: Option<&Description>) -> Option<Side> {
        self.first.or_else(|| {
            rig.map(|rig| match rig.wiring.first {
                First::Left => Side::Left,
                First::Right => Side::Right,
            })
        })
    }

    /// The wiring with the rig's values where nothing was told. One or the other must tell the kind. The rig's
    /// skew goes with its kind: another one has none.
    pub(in crate::command) fn get_with(&self, rig: Option<&Description>) -> Result<Wiring> {
        let Some(Wiring { kind, skew, .. }) = rig.map(|rig| rig.wiring) else { return self.get_required() };
        let skew = self.wiring.is_none_or(|asked| asked == kind).then_some(skew);
        let merged = Self { wiring: self.wiring.or(Some(kind)), first: self.first_with(rig), skew: self.skew.or(skew) };
        merged.get_required()
    }

    /// The wiring, which must be told.
    pub(in crate::command) fn get_required(&self) -> Result<Wiring> {
        self.get()?.with_context(|| {
            let names: Vec<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
            format!("--wiring is missing, the order of the pixels: one of {}", names.join(", "))
        })
    }
}

/// Reads one of `all` by its name.
fn by_name<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let names = all.iter().map(|&value| name(value));
    PossibleValuesParser::new(names).map(move |text| {
        let found = all.iter().find(|&&value| name(value) == text);
        *found.expect("only names of these are possible")
    })
}
