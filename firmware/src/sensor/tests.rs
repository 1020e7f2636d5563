use super::exposure::ExposureCopy;
use super::fake::Fake;
use super::hm01b0::{self, Clock, Hm01b0, Lines};
use super::mt9v034::{self, Mt9v034};
use super::*;

const HM01B0: hm01b0::Setup = hm01b0::Setup {
    lines: Lines::Four,
    clock: Clock::Quarter,
    line_length: 500,
    exposure: hm01b0::Exposure::Fixed(0x0102),
};
const MT9V034: mt9v034::Setup =
    mt9v034::Setup { size: [320, 240], line_length: 1600, exposure: mt9v034::Exposure::Fixed(30), most_lines: 60 };

fn hm01b0() -> Fake {
    Fake::new(0x24, 2, &[(0, 0x01), (1, 0xB0)])
}

fn mt9v034() -> Fake {
    Fake::new(0x48, 1, &[(0, 0x1324)])
}

/// Sets it up and starts it, as a board does.
fn whole<S: Sensor>(fake: &mut Fake, setup: S::Setup) -> Result<(), SensorError<()>> {
    let address = find::<S, _>(fake)?;
    apply::<S, _>(fake, address, S::reset())?;
    set_up::<S, _>(fake, address, setup)?;
    apply::<S, _>(fake, address, S::start(setup))?;
    Ok(())
}

/// It shows frames after its last access, and never where one failed.
fn starts_last<S: Sensor>(fake: fn() -> Fake, setup: S::Setup) {
    let Setting { register, value, .. } = S::start(setup);
    let mut good = fake();
    assert_eq!(whole::<S>(&mut good, setup), Ok(()));
    assert_eq!(good.written.last(), Some(&(register, value)));
    let accesses = usize::MAX - good.answers;
    for answers in 0..accesses {
        let mut sensor = Fake { answers, ..fake() };
        assert_eq!(whole::<S>(&mut sensor, setup), Err(SensorError::Silent(())));
        assert!(!sensor.written.contains(&(register, value)), "started after {answers} accesses");
    }
    for setting in S::settings(setup).filter(|setting| setting.value != 0) {
        let mut sensor = Fake { forgets: Some(setting.register), ..fake() };
        let forgets = SensorError::Forgets(setting.register, setting.value, 0);
        assert_eq!(whole::<S>(&mut sensor, setup), Err(forgets));
    }
}

#[test]
fn a_sensor_is_started_last_and_only_if_it_holds_every_register() {
    starts_last::<Hm01b0>(hm01b0, HM01B0);
    starts_last::<Mt9v034>(mt9v034, MT9V034);
}

#[test]
fn no_register_is_set_twice() {
    let set = |settings: &[Setting]| {
        settings.iter().map(|setting| setting.register).collect::<std::collections::BTreeSet<_>>()
    };
    let hm01b0: Vec<_> = Hm01b0::settings(HM01B0).collect();
    let mt9v034: Vec<_> = Mt9v034::settings(MT9V034).collect();
    assert_eq!([set(&hm01b0).len(), set(&mt9v034).len()], [hm01b0.len(), mt9v034.len()]);
}

#[test]
fn another_model_is_refused_and_silence_is_no_model() {
    let mut other = Fake::new(0x24, 2, &[(1, 0x60)]);
    assert_eq!(whole::<Hm01b0>(&mut other, HM01B0), Err(SensorError::Model(0x60)));
    let mut older = Fake::new(0x5C, 1, &[(0, 0x1313)]);
    assert_eq!(whole::<Mt9v034>(&mut older, MT9V034), Err(SensorError::Model(0x1313)));
    let mut elsewhere = Fake::new(0x30, 1, &[(0, 0x1324)]);
    assert_eq!(whole::<Mt9v034>(&mut elsewhere, MT9V034), Err(SensorError::Silent(())));
}

#[test]
fn the_mt9v034_shows_the_middle_of_its_array() {
    let mut sensor = mt9v034();
    whole::<Mt9v034>(&mut sensor, MT9V034).unwrap();
    let held = |register: u16| sensor.registers[&register];
    // Columns 57 to 696 of 752, rows 4 to 483 of 480, and a line of 1600 clocks.
    assert_eq!([1, 4, 5].map(held), [57, 640, 960]);
    assert_eq!([2, 3].map(held), [4, 480]);
    assert_eq!([0x07, 0x0D, 0x0B, 0xAF].map(held), [0x398, 0x305, 30, 0]);
}

#[test]
fn the_hm01b0_takes_the_clock_on_its_pin_and_latches_what_it_holds() {
    let mut sensor = hm01b0();
    whole::<Hm01b0>(&mut sensor, HM01B0).unwrap();
    let held = |register: u16| sensor.registers[&register];
    assert_eq!([0x3067, 0x3068, 0x3059, 0x3060].map(held), [0, 0x20, 0x42, 0b1_1001]);
    assert_eq!([0x0202, 0x0203, 0x2100, 0x0342, 0x0343].map(held), [1, 2, 0, 1, 0xF4]);
    let [.., latch, start] = sensor.written[..] else { panic!("too few") };
    assert_eq!([latch, start], [(0x0104, 1), (0x0100, 1)]);
}

#[test]
fn only_a_sensor_that_nobody_else_controls_controls_its_exposure() {
    use hm01b0::Exposure::{Copied, Fixed, Own};
    for (exposure, control) in [(Own, 1), (Fixed(9), 0), (Copied, 0)] {
        let mut sensor = hm01b0();
        assert_eq!(whole::<Hm01b0>(&mut sensor, hm01b0::Setup { exposure, ..HM01B0 }), Ok(()));
        assert_eq!(sensor.registers[&0x2100], control, "{exposure:?}");
    }
    use mt9v034::Exposure as E;
    for (exposure, control) in [(E::Own, 3), (E::Fixed(9), 0), (E::Copied, 0)] {
        let mut sensor = mt9v034();
        assert_eq!(whole::<Mt9v034>(&mut sensor, mt9v034::Setup { exposure, ..MT9V034 }), Ok(()));
        assert_eq!(sensor.registers[&0xAF], control, "{exposure:?}");
    }
}

/// The exposure is copied whole, and anew after a silence.
fn copies<S: Sensor>(mut from: Fake, mut to: Fake) {
    let (at, address) = (to.address, from.address);
    from.registers.extend(S::EXPOSURE.iter().map(|&(register, _)| register).zip(1..));
    let mut copy = ExposureCopy::<S>::default();
    let mut run = |to: &mut Fake| {
        (0..20).find_map(|_| {
            copy.step((&mut from, address), (&mut *to, at)).map_or(Some(false), |done| done.then_some(true))
        })
    };
    to.answers = 1;
    assert_eq!(run(&mut to), Some(false));
    to.answers = 6;
    assert_eq!(run(&mut to), Some(true));
    let copied: Vec<u16> = S::EXPOSURE.iter().map(|(_, register)| to.registers[register]).collect();
    assert_eq!(copied, (1..).take(copied.len()).collect::<Vec<u16>>());
}

#[test]
fn an_exposure_is_copied_whole_and_anew_after_a_silence() {
    copies::<Hm01b0>(hm01b0(), hm01b0());
    copies::<Mt9v034>(mt9v034(), mt9v034());
}
