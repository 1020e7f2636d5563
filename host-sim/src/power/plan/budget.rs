//! A plan: whether a method keeps up at a frame rate, at which clock, and what that takes.

use anyhow::Result;
use serde::Serialize;

use super::cost::{Costs, InputCost};
use super::counts::Input;
use super::currents::{Board, Chip, Currents, OperatingPoint, Sensor, SensorModel};
use super::standby;
use crate::stereo::method::MethodKind;
use crate::twin::cycles::Range;

/// So much of its time a core may be busy: what is left is for interrupts, and for rows that come faster than the mean.
pub const MOST_BUSY: f64 = 0.9;
/// Instructions of a pixel that the board's program executes besides the method and its packets: capture, interrupts, obstacles,
/// messages. Of the emulated STM32H743, where `full` takes 150 a pixel with everything, and 122 in the twin.
pub const PROGRAM: f64 = 30.0;
/// Both.
const SENSORS: f64 = 2.0;

/// What is planned.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// The board.
    pub board: Board,
    /// The method.
    pub method: MethodKind,
    /// Size of a view, px.
    pub width: u16,
    /// The same.
    pub height: u16,
    /// Disparities searched.
    pub disparities: u16,
    /// Frames a second.
    pub fps: f64,
    /// The sensors, unless they are somebody else's.
    pub sensor: Option<SensorModel>,
    /// Their fixed integration, lines, with which they sleep between frames; else they are always on.
    pub exposure_lines: Option<u16>,
    /// What it runs from.
    pub battery: Option<Battery>,
}

impl Request {
    /// Part of the time that the sensors are awake.
    fn awake(&self) -> f64 {
        self.exposure_lines.map_or(1.0, |lines| standby::awake(self.width, self.height, lines, self.fps))
    }
}

/// A battery.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Battery {
    /// Charge, mAh.
    pub mah: f64,
    /// Mean voltage, V.
    pub volts: f64,
}

/// Instructions of a pixel by input.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Inputs {
    /// Recorded frames as they are.
    pub clean: InputCost,
    /// With noise of 10 grey levels.
    pub noisy: InputCost,
    /// Views of random bytes.
    pub random: InputCost,
}

/// An operating point, and what the method makes of it.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// What the manual calls its voltage.
    pub name: String,
    /// Clock, MHz.
    pub mhz: f64,
    /// Share of its time that the core is busy, %; 100 or more never keeps up.
    pub busy_percent: Range,
    /// With noisy frames.
    pub busy_noisy_percent: f64,
    /// Whether noisy frames keep the core busy for no more than [`MOST_BUSY`].
    pub fits: bool,
    /// Mean power of the core, mW; at most that of one that never sleeps.
    pub core_mw: Range,
    /// Energy of the core for a pixel, its sleep with it, nJ.
    pub nj_per_pixel: Range,
}

/// Power and what follows from it at the clock that was chosen.
#[derive(Debug, Clone, Serialize)]
pub struct Budget {
    /// Mean power of the core.
    pub core_mw: Range,
    /// Mean power of both sensors.
    pub sensors_mw: f64,
    /// Part of the time that these are in standby, %.
    pub standby_percent: f64,
    /// What the supply loses.
    pub supply_mw: Range,
    /// All of it.
    pub total_mw: Range,
    /// Frames for each joule of all of it.
    pub frames_per_joule: f64,
    /// Hours that the battery lasts.
    pub hours: Option<Range>,
}

/// What would fit where the plan does not.
#[derive(Debug, Clone, Serialize)]
pub struct Instead {
    /// How many times the time that there is the method would need.
    pub over: f64,
    /// The highest frame rate at that size.
    pub fps: f64,
    /// The widest views of the same shape at that rate, if any are.
    pub smaller: Option<Smaller>,
    /// Methods that would fit.
    pub methods: Vec<&'static str>,
    /// Boards on which it would fit.
    pub boards: Vec<&'static str>,
}

/// Smaller views, in which the same is seen.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Smaller {
    /// Size of a view, px.
    pub width: u16,
    /// The same.
    pub height: u16,
    /// Disparities that reach as near, up to a multiple of 16.
    pub disparities: u16,
}

/// A plan.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// What it rests on.
    pub model: &'static str,
    /// The board.
    pub board: Board,
    /// Its chip.
    pub chip: String,
    /// Its processor.
    pub core: &'static str,
    /// The method's name.
    pub method: &'static str,
    /// Size of a view, px.
    pub width: u16,
    /// The same.
    pub height: u16,
    /// Disparities searched.
    pub disparities: u16,
    /// Frames a second.
    pub fps: f64,
    /// Executed instructions of a pixel, packets with them.
    pub instructions_per_pixel: Inputs,
    /// Cycles of an instruction.
    pub cycles_per_instruction: Range,
    /// Cycles of a pixel with all that the program does: clean frames, and the least and the most of any input and of the model
    /// of cycles.
    pub cycles_per_pixel: Range,
    /// All clocks, the fastest first.
    pub points: Vec<Point>,
    /// The number of the least clock that fits, of the points.
    pub chosen: Option<usize>,
    /// Whether the most of any input and of the model of cycles fits, too.
    pub is_sure: bool,
    /// What it takes at that clock.
    pub budget: Option<Budget>,
    /// What would fit if it does not.
    pub instead: Option<Instead>,
    /// What the figures rest on, each with its source.
    pub sources: Vec<String>,
    /// How many of these are not verified.
    pub not_verified: usize,
}

/// What every plan says of itself.
pub const MODEL: &str = "model, not measured";

/// Makes plans.
#[derive(Debug)]
pub struct Planner<'a> {
    /// What a pixel costs.
    pub costs: &'a Costs,
    /// What chips and sensors take.
    pub currents: &'a Currents,
}

impl Planner<'_> {
    /// The plan for a request, and what else would fit.
    ///
    /// # Errors
    /// If the method was not counted at such a size.
    pub fn plan(&self, request: &Request) -> Result<Plan> {
        let mut plan = self.plan_alone(request)?;
        if plan.chosen.is_none() {
            plan.instead = Some(self.instead(request, &plan)?);
        }
        Ok(plan)
    }

    fn plan_alone(&self, request: &Request) -> Result<Plan> {
        let Request { board, method, width, height, disparities, fps, .. } = *request;
        let chip = self.currents.chip(board);
        let cost = |input| self.costs.of(chip.core).of(method, input, width, disparities);
        let inputs = Inputs { clean: cost(Input::Clean)?, noisy: cost(Input::Noisy)?, random: cost(Input::Random)? };
        let every = [inputs.clean, inputs.noisy, inputs.random];
        let instructions = Range {
            least: every.iter().map(|cost| cost.least).fold(f64::INFINITY, f64::min),
            likely: inputs.clean.mean.all(),
            most: every.iter().map(|cost| cost.most).fold(0.0, f64::max),
        }
        .map(|instructions| instructions + PROGRAM);
        let cycles_per_instruction = chip.core.cycles();
        let cycles_per_pixel = instructions.times(cycles_per_instruction);
        let rate = f64::from(width) * f64::from(height) * fps;
        let noisy = (inputs.noisy.mean.all() + PROGRAM) * cycles_per_instruction.likely;
        let point = |point: &OperatingPoint| Point::new(chip, point, cycles_per_pixel, noisy, rate);
        let points: Vec<Point> = chip.points.iter().map(point).collect();
        let chosen = points.iter().rposition(|point| point.fits);
        let mut plan = Plan {
            model: MODEL,
            board,
            chip: chip.name.clone(),
            core: chip.core.name(),
            method: method.name(),
            width,
            height,
            disparities,
            fps,
            instructions_per_pixel: inputs,
            cycles_per_instruction,
            cycles_per_pixel,
            is_sure: chosen.is_some_and(|nth| points[nth].busy_percent.most <= 100.0 * MOST_BUSY),
            points,
            chosen,
            budget: None,
            instead: None,
            sources: Vec::new(),
            not_verified: 0,
        };
        if let Some(nth) = chosen {
            plan.budget = Some(self.budget(request, plan.points[nth].core_mw)?);
        }
        plan.sources = self.sources(request, &plan)?;
        plan.not_verified = plan.sources.iter().filter(|source| source.contains("not verified")).count();
        Ok(plan)
    }

    fn budget(&self, request: &Request, core_mw: Range) -> Result<Budget> {
        let sensor = request.sensor.map(|model| self.currents.sensor(model)).transpose()?;
        let (mut sensors_mw, mut standby_percent) = (0.0, 0.0);
        if let Some(Sensor { volts, active, standby }) = sensor {
            // Of somebody's own currents without one: as if it never slept.
            let (awake, standby) = (request.awake(), standby.as_ref().unwrap_or(active));
            sensors_mw = SENSORS * volts * (awake * active.ma + (1.0 - awake) * standby.ma);
            standby_percent = 100.0 * (1.0 - awake);
        }
        let efficiency = self.currents.supply.efficiency;
        let total_mw = core_mw.map(|core| (core + sensors_mw) / efficiency);
        let hours = request.battery.map(|Battery { mah, volts }| {
            let hours = |total: f64| mah * volts / total;
            Range { least: hours(total_mw.most), likely: hours(total_mw.likely), most: hours(total_mw.least) }
        });
        Ok(Budget {
            core_mw,
            sensors_mw,
            standby_percent,
            supply_mw: total_mw.map(|total| total * (1.0 - efficiency)),
            total_mw,
            frames_per_joule: 1e3 * request.fps / total_mw.likely,
            hours,
        })
    }

    /// What the figures rest on.
    fn sources(&self, request: &Request, plan: &Plan) -> Result<Vec<String>> {
        let program = format!(
            "{PROGRAM} instructions a pixel of the program around the method: measured on an emulated STM32H743"
        );
        let mut sources = vec![
            program,
            format!(
                "{:.2} ({:.2} to {:.2}) cycles an instruction on the {}: not verified, a model of classes of instructions",
                plan.cycles_per_instruction.likely,
                plan.cycles_per_instruction.least,
                plan.cycles_per_instruction.most,
                plan.core
            ),
        ];
        let chip = self.currents.chip(request.board);
        let points = match plan.chosen {
            Some(nth) => &chip.points[nth..=nth],
            None => &chip.points[..],
        };
        for OperatingPoint { name, run, sleep, .. } in points {
            for (what, current) in [("runs", run), ("sleeps", sleep)] {
                sources.push(format!("{} {what} at {name} with {} mA: {}", chip.name, current.ma, current.source()?));
            }
        }
        if let (Some(model), Some(_)) = (request.sensor, plan.chosen) {
            let sensor = self.currents.sensor(model)?;
            let (ma, source) = (sensor.active.ma, sensor.active.source()?);
            sources.push(format!("each {} takes {ma} mA at {} V: {source}", model.name(), sensor.volts));
            if let Some(standby) = sensor.standby.as_ref().filter(|_| request.awake() < 1.0) {
                sources.push(format!("each takes {} mA in standby: {}", standby.ma, standby.source()?));
            }
        }
        if plan.chosen.is_some() {
            let supply = &self.currents.supply;
            sources.push(format!("supply of {} % efficiency: {}", 100.0 * supply.efficiency, supply.source()));
        }
        Ok(sources)
    }

    fn instead(&self, request: &Request, plan: &Plan) -> Result<Instead> {
        let fastest = &plan.points[0];
        let over = fastest.busy_noisy_percent / 100.0 / MOST_BUSY;
        let fits = |request: Request| self.plan_alone(&request).is_ok_and(|plan| plan.chosen.is_some());
        // Disparities shrink with the views, so that the nearest distance stays.
        let narrower = (1..).map(|steps| request.width.saturating_sub(16 * steps)).take_while(|&width| width >= 64);
        let size = |width: u16| {
            let part = f64::from(width) / f64::from(request.width);
            let shrunk = |value: u16| (part * f64::from(value)).round().max(1.0) as u16;
            let disparities = shrunk(request.disparities).next_multiple_of(16);
            Request { width, height: shrunk(request.height), disparities, ..*request }
        };
        let smaller = narrower.map(size).find(|&request| fits(request));
        let methods = super::counting::METHODS.into_iter().filter(|&method| fits(Request { method, ..*request }));
        let boards = [Board::H743, Board::U575, Board::F407].into_iter();
        let boards = boards.filter(|&board| fits(Request { board, ..*request })).map(Board::name);
        Ok(Instead {
            over,
            fps: request.fps / over,
            smaller: smaller.map(|Request { width, height, disparities, .. }| Smaller { width, height, disparities }),
            methods: methods.map(MethodKind::name).collect(),
            boards: boards.collect(),
        })
    }
}

impl Point {
    fn new(chip: &Chip, point: &OperatingPoint, cycles_per_pixel: Range, noisy: f64, rate: f64) -> Self {
        let busy = |cycles: f64| cycles * rate / (point.mhz * 1e6);
        let mw = |share: f64| {
            let share = share.min(1.0);
            chip.volts * (share * point.run.ma + (1.0 - share) * point.sleep.ma)
        };
        let core_mw = cycles_per_pixel.map(|cycles| mw(busy(cycles)));
        Self {
            name: point.name.clone(),
            mhz: point.mhz,
            busy_percent: cycles_per_pixel.map(|cycles| 100.0 * busy(cycles)),
            busy_noisy_percent: 100.0 * busy(noisy),
            fits: busy(noisy) <= MOST_BUSY,
            core_mw,
            nj_per_pixel: core_mw.map(|mw| 1e6 * mw / rate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request() -> Request {
        Request {
            board: Board::H743,
            method: MethodKind::Lite,
            width: 320,
            height: 240,
            disparities: 48,
            fps: 30.0,
            sensor: Some(SensorModel::Mt9v034),
            exposure_lines: None,
            battery: Some(Battery { mah: 1000.0, volts: 3.7 }),
        }
    }

    fn with(act: impl FnOnce(&Planner<'_>)) {
        let (costs, currents) = (Costs::stored().unwrap(), Currents::own().unwrap());
        act(&Planner { costs: &costs, currents: &currents });
    }

    #[test]
    fn power_adds_up_and_the_battery_lasts_as_long_as_its_energy() {
        with(|planner| {
            let plan = planner.plan(&request()).unwrap();
            let budget = plan.budget.clone().unwrap();
            let sum = budget.core_mw.likely + budget.sensors_mw + budget.supply_mw.likely;
            assert!((sum - budget.total_mw.likely).abs() < 1e-9);
            let joules = budget.hours.unwrap().likely * 3600.0 * budget.total_mw.likely / 1e3;
            assert!((joules - 3600.0 * 3.7).abs() < 1e-6);
            assert!((budget.frames_per_joule * budget.total_mw.likely / 1e3 - 30.0).abs() < 1e-9);
            let point = &plan.points[plan.chosen.unwrap()];
            let pixels = 320.0 * 240.0 * 30.0;
            assert!((point.nj_per_pixel.likely * pixels / 1e6 - budget.core_mw.likely).abs() < 1e-9);
            // Full-load power at the share of its time that it is busy, the rest asleep.
            let chip = planner.currents.chip(Board::H743);
            let at = &chip.points[plan.chosen.unwrap()];
            let busy = plan.cycles_per_pixel.likely * pixels / at.mhz / 1e6;
            let expected = chip.volts * (busy * at.run.ma + (1.0 - busy) * at.sleep.ma);
            assert!((budget.core_mw.likely - expected).abs() < 1e-9);
            assert_eq!(plan.not_verified, plan.sources.len() - 2, "no current but the sensors' was looked up yet");
        });
    }

    #[test]
    fn sensors_that_sleep_between_frames_take_their_part_of_the_time() {
        with(|planner| {
            let budget = |exposure_lines| {
                let plan = planner.plan(&Request { fps: 5.0, exposure_lines, ..request() }).unwrap();
                (plan.budget.unwrap(), plan.sources.iter().any(|source| source.contains("in standby")))
            };
            let ((always, told), (sleeping, told_asleep)) = (budget(None), budget(Some(60)));
            assert!(!told && told_asleep);
            let Sensor { volts, active, standby } = planner.currents.sensor(SensorModel::Mt9v034).unwrap();
            let standby = standby.as_ref().unwrap().ma;
            assert!((always.sensors_mw - 2.0 * volts * active.ma).abs() < 1e-9 && always.standby_percent == 0.0);
            let awake = 1.0 - sleeping.standby_percent / 100.0;
            assert!((0.15..0.25).contains(&awake), "{awake}");
            let expected = 2.0 * volts * (awake * active.ma + (1.0 - awake) * standby);
            assert!((sleeping.sensors_mw - expected).abs() < 1e-9);
        });
    }

    #[test]
    fn the_clock_is_the_least_that_fits() {
        with(|planner| {
            let mut chosen = Vec::new();
            for fps in [2.0, 25.0, 30.0] {
                let plan = planner.plan(&Request { fps, ..request() }).unwrap();
                let nth = plan.chosen.unwrap();
                assert!(plan.points[nth].busy_noisy_percent <= 90.0);
                assert!(plan.points[nth + 1..].iter().all(|point| point.busy_noisy_percent > 90.0));
                chosen.push(plan.points[nth].mhz);
            }
            assert!(chosen.is_sorted() && chosen[0] == 200.0 && chosen[2] > 200.0, "{chosen:?}");
        });
    }

    #[test]
    fn what_does_not_fit_says_by_how_much_and_what_would() {
        with(|planner| {
            let asked = Request { board: Board::U575, ..request() };
            let plan = planner.plan(&asked).unwrap();
            let instead = plan.instead.unwrap();
            assert!(plan.budget.is_none() && instead.over > 1.0);
            // Just below the rate that is told it fits, just above it does not.
            let fits = |fps| planner.plan(&Request { fps, ..asked }).unwrap().chosen.is_some();
            assert!(fits(0.999 * instead.fps) && !fits(1.001 * instead.fps), "{instead:?}");
            let Smaller { width, height, disparities } = instead.smaller.unwrap();
            assert!(planner.plan(&Request { width, height, disparities, ..asked }).unwrap().chosen.is_some());
            assert_eq!(instead.boards, ["h743"]);
            assert!(instead.methods.is_empty(), "{instead:?}");
        });
    }

    #[test]
    fn ranges_are_in_order() {
        with(|planner| {
            for method in super::super::counting::METHODS {
                for board in [Board::H743, Board::U575, Board::F407] {
                    let plan = planner.plan(&Request { board, method, ..request() }).unwrap();
                    for Range { least, likely, most } in
                        plan.points.iter().flat_map(|point| [point.busy_percent, point.core_mw, point.nj_per_pixel])
                    {
                        assert!(0.0 < least && least <= likely && likely <= most, "{method} {board:?}");
                    }
                }
            }
        });
    }
}
