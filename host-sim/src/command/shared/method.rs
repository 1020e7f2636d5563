//! Which method, and its settings.

use anyhow::{Context, Result, bail};
use haarline::{ContourSettings, Scales};

use crate::command::whole_number;
use crate::stereo::method::{Method, MethodKind};

/// Which method, and its settings.
#[derive(Debug, clap::Args)]
pub(in crate::command) struct MethodOptions {
    /// How to match
    #[arg(long, value_enum, default_value_t = MethodKind::BEST)]
    method: MethodKind,
    /// With --method contour: half-support of the Haar wavelet along rows and columns, px, 1 to 16
    /// [default: 2 along rows, 1 along columns]
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = whole_number, conflicts_with = "scales")]
    half_support: Option<i64>,
    /// With --method contour: several half-supports, of whose contours all are matched
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', allow_hyphen_values = true, value_parser = whole_number)]
    scales: Vec<i64>,
}

impl MethodOptions {
    /// The method's name.
    pub(in crate::command) fn name(&self) -> &'static str {
        self.method.name()
    }

    /// The method with its settings.
    pub(in crate::command) fn get(&self) -> Result<Method> {
        let (option, half_supports) = match self.half_support {
            Some(half_support) => ("--half-support", vec![half_support]),
            None => ("--scales", self.scales.clone()),
        };
        let mut method = Method::from(self.method);
        if half_supports.is_empty() {
            return Ok(method);
        }
        if self.method != MethodKind::Contour {
            bail!("{option}: is for --method contour, not for {}", self.method);
        }
        let mut valid = Vec::new();
        for half_support in half_supports {
            let found = u8::try_from(half_support).ok().filter(|s| (1..=Scales::MAX_HALF_SUPPORT).contains(s));
            valid.push(found.with_context(|| format!("{option} {half_support}: must be 1 to 16 px"))?);
        }
        let scales = Scales::new(&valid)?;
        method.contours = ContourSettings { rows: scales, columns: scales, ..method.contours };
        Ok(method)
    }
}
