//! Random touches of the pipe: beside the crown, leaning, drifting, cancelled at any time.
//!
//! The whole stack flies on a receiver's bytes. The vehicle hovers, is moved over the pipe while it leans (no sensor
//! measures position), and sinks onto it. A pilot who sees it leave the pipe climbs away.

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use sophie_control::mode::{Mode, Reason};
use sophie_control::pilot::rc::Sticks;

use sophie_sim::devices::crsf::{FRAME_HZ, rc_frame};
use sophie_sim::flight::aircraft::Aircraft;
use sophie_sim::flight::stack::Stack;
use sophie_sim::plant::Plant;
use sophie_sim::plant::contact::BELLY_Z;
use sophie_sim::scenario::Scenario;
use sophie_sim::streams::Streams;

/// s.
const ARMED_BY: f64 = 12.0;
/// Hover before the touch, and the lean at its end, s.
const HOVER: f64 = 2.0;
const LEANING: f64 = 0.8;
/// m.
const HEIGHT: f64 = 12.0;
/// Over the pipe at the start, m.
const ABOVE: f64 = 0.01;
/// How often the propellers' clearance is looked at, ms.
const CLEARANCE_EVERY: u32 = 5;
/// Time from there, s.
const DURATION: f64 = 14.0;
/// Of the pilot, s.
const REACTION: f64 = 0.35;
/// Throttle of the set-down, and its slew rate, 1/s.
const SET_DOWN: f64 = 0.40;
const EASE: f64 = 0.5;
/// Lean (rad) and depth below the touch height (m) at which the pilot sees it slide.
const SEEN_LEAN: f64 = 0.5;
const SEEN_DEPTH: f64 = 0.06;
/// Below the touch height, m: the ground under the lowest pipe.
const LOST_DEPTH: f64 = 0.95;
/// Height over the touch height clear of the pipe, m.
const CLEAR: f64 = 0.4;
/// On the pipe before the arms open, s; throttle there.
pub const STAY: f64 = 2.0;
const RELEASE: f64 = 0.25;

/// A touch to try.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Centre of mass beside the crown line at the touch, m.
    pub offset: f64,
    /// Roll at the touch, rad.
    pub lean: f64,
    /// Sink rate, m/s.
    pub sink: f64,
    /// Sideways speed, right positive, m/s.
    pub sideways: f64,
    /// Heading against the pipe, rad, right positive.
    pub yaw: f64,
    /// Diameter of the pipe, m.
    pub diameter: f64,
    /// Its coefficient of friction.
    pub friction: f64,
    /// RMS of the gusts, N.
    pub gust: f64,
    /// Throttle while the arms close.
    pub throttle: f64,
    /// Time from touch to perch switch off, s; infinite: never.
    pub cancel: f64,
    /// On the pipe before the arms open, s.
    pub stay: f64,
    /// Seed of sensor errors and gusts.
    pub seed: u64,
}

impl Touch {
    /// Within ±150 mm, ±25°, pipes of 0.2 to 0.4 m, friction 0.3 to 0.8; half cancelled.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        let streams = Streams::new(seed);
        let within = |what: &str, from: f64, to: f64| streams.within(&format!("touch.{what}"), from, to);
        let diameter = within("diameter", 0.2, 0.4);
        Self {
            // Within the width of a thinner pipe.
            offset: within("offset", -0.15, 0.15).clamp(-0.48 * diameter, 0.48 * diameter),
            lean: within("lean", -25.0, 25.0).to_radians(),
            sink: within("sink", 0.05, 0.4),
            sideways: within("sideways", -0.1, 0.1),
            yaw: 0.0,
            diameter,
            friction: within("friction", 0.3, 0.8),
            gust: within("gust", 0.0, 0.1),
            throttle: within("throttle", 0.15, 0.38),
            cancel: match within("cancel", -8.0, 8.0) {
                t if t < 0.0 => f64::INFINITY,
                t => t,
            },
            stay: STAY,
            seed,
        }
    }
}

/// How a touch ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// On the pipe; with the switch off, leaning too far to let go.
    Perched,
    /// In the air after a perch.
    Released,
    /// In the air without a perch.
    Away,
    /// On the ground, or falling.
    Lost,
}

/// Result of a touch.
#[derive(Clone, Copy, Debug)]
pub struct Touched {
    /// How it ended.
    pub end: End,
    /// Largest depth below the touch height, m.
    pub drop: f64,
    /// Largest lean, rad.
    pub lean: f64,
    /// Largest true pressure on an arm, Pa.
    pub pressure: f64,
    /// The same before the arms close, and after they let go, Pa: bumps of open arms.
    pub bump: f64,
    /// The vehicle escaped from the pipe.
    pub escaped: bool,
    /// The arms began to close.
    pub closed: bool,
    /// The grip was proven.
    pub proven: bool,
    /// Largest true pressure on an arm in the last closing, that which ended in proof where one did, Pa; without the bumps
    /// of open arms.
    pub closing_pressure: f64,
    /// Least distance of a turning propeller from the pipe, m.
    pub clearance: f64,
    /// Mode at the end.
    pub mode: Mode,
    /// What the pilot last read while it escaped or let go.
    pub why: Option<Reason>,
}

struct Hand {
    sticks: Sticks,
    /// Modes displayed within the reaction time.
    display: VecDeque<Mode>,
    perched: f64,
    releases: bool,
    climbs: bool,
}

struct Try {
    scenario: Scenario,
    plant: Plant,
    stack: Stack,
    ms: u64,
    elapsed: f64,
}

impl Try {
    fn new(mut scenario: Scenario, touch: &Touch) -> Self {
        scenario.seed = touch.seed;
        scenario.world.pipe_diameter = touch.diameter;
        scenario.world.pipe_friction = touch.friction;
        scenario.world.gust_force = touch.gust;
        scenario.world.gust_moment = 0.04 * touch.gust;
        let plant = scenario.plant();
        let stack = Stack::new(&scenario);
        Self {
            scenario,
            plant,
            stack,
            ms: 0,
            elapsed: 0.0,
        }
    }

    fn step(&mut self, sticks: &Sticks) {
        self.ms += 1;
        self.stack.step_world(&mut self.plant);
        self.elapsed += 1e-3;
        if self.elapsed >= 1.0 / FRAME_HZ {
            self.elapsed -= 1.0 / FRAME_HZ;
            self.stack.receive(&rc_frame(sticks));
        }
        let _ = self.stack.run_until(self.ms * 1000);
    }

    fn roll(&self) -> f64 {
        self.plant.euler()[0]
    }

    fn climb(&self, rate: f64) -> f32 {
        let hover =
            f64::from(self.scenario.params.mass) * 9.81 / (4.0 * f64::from(self.scenario.params.thrust_max));
        (hover + 0.25 * (rate + self.plant.pose().velocity.z)).clamp(0.2, 0.9) as f32
    }

    /// Arms and hovers, leaning at the end; false if arming fails.
    fn take_off(&mut self, lean: f64) -> bool {
        let mut sticks = Sticks::default();
        while self.stack.mode() != Mode::Armed {
            if self.ms as f64 * 1e-3 > ARMED_BY {
                return false;
            }
            sticks.arm_switch = self.stack.mode() == Mode::Disarmed;
            sticks.yaw = if sticks.arm_switch { 1.0 } else { 0.0 };
            self.step(&sticks);
        }
        sticks.yaw = 0.0;
        self.plant.place(DVec3::new(0.0, 0.0, -HEIGHT), DVec3::ZERO);
        for ms in 0..((HOVER + LEANING) * 1e3) as u32 {
            sticks.throttle = self.climb(0.0);
            if f64::from(ms) > HOVER * 1e3 {
                sticks.roll = (lean / f64::from(self.scenario.params.stick_angle)).clamp(-1.0, 1.0) as f32;
            }
            self.step(&sticks);
        }
        true
    }

    /// Returns the down coordinate at the touch, m.
    fn put_over(&mut self, touch: &Touch) -> f64 {
        let world = &self.scenario.world;
        let [north, east] = world.pipe_position;
        let radius = 0.5 * touch.diameter;
        let axis = -world.pipe_top + radius;
        if touch.yaw != 0.0 {
            self.plant.turn(touch.yaw);
        }
        let down = touch_height(
            self.plant.pose().attitude,
            touch.offset,
            radius,
            &self.plant.underside(),
        ) + axis;
        self.plant.place(
            DVec3::new(north, east + touch.offset, down - ABOVE),
            DVec3::new(0.0, touch.sideways, touch.sink),
        );
        down
    }
}

/// Distance of the centre of mass below the pipe's axis (negative above) at the first contact of belly or arms, m.
fn touch_height(attitude: DQuat, offset: f64, radius: f64, arms: &[[DVec3; 3]; 4]) -> f64 {
    let belly = [-0.03, 0.03].map(|y| DVec3::new(0.0, y, BELLY_Z));
    belly
        .into_iter()
        .chain(arms.iter().flatten().copied())
        .filter_map(|point| {
            let r = attitude * point;
            let beside = offset + r.y;
            (beside.abs() < radius).then(|| -(radius * radius - beside * beside).sqrt() - r.z)
        })
        .fold(-BELLY_Z, f64::min)
}

/// With the default vehicle; `None` if arming fails.
#[must_use]
pub fn fly(touch: &Touch) -> Option<Touched> {
    fly_as(Scenario::default_mission(), touch, |_, _, _| ())
}

/// With the vehicle of `scenario`; `each` millisecond sees the time since the set-down (s), and may change the plant.
#[must_use]
pub fn fly_as(
    scenario: Scenario,
    touch: &Touch,
    mut each: impl FnMut(f64, &mut Plant, &Stack),
) -> Option<Touched> {
    let mut flight = Try::new(scenario, touch);
    if !flight.take_off(touch.lean) {
        return None;
    }
    let height = flight.put_over(touch);
    let mut hand = Hand {
        sticks: Sticks {
            arm_switch: true,
            perch_switch: true,
            arms: flight.scenario.arms,
            throttle: SET_DOWN as f32,
            ..Sticks::default()
        },
        display: VecDeque::new(),
        perched: 0.0,
        releases: false,
        climbs: false,
    };
    let mut out = Touched {
        end: End::Lost,
        drop: 0.0,
        lean: 0.0,
        pressure: 0.0,
        bump: 0.0,
        escaped: false,
        closed: false,
        proven: false,
        closing_pressure: 0.0,
        clearance: f64::INFINITY,
        mode: Mode::Flight,
        why: None,
    };
    let duration = DURATION + touch.stay - STAY;
    for ms in 0..(duration * 1e3) as u32 {
        hand.act(&flight, f64::from(ms) * 1e-3, touch, height);
        flight.step(&hand.sticks);
        each(f64::from(ms) * 1e-3, &mut flight.plant, &flight.stack);
        let mode = flight.stack.mode();
        if mode == Mode::Clamping && out.mode != mode {
            out.closing_pressure = 0.0;
        }
        if matches!(mode, Mode::Escaping | Mode::Releasing) {
            let status = flight.stack.links.status.latest();
            out.why = status.and_then(|s| s.value.reason).or(out.why);
        }
        out.mode = mode;
        out.escaped |= mode == Mode::Escaping;
        out.drop = out.drop.max(flight.plant.pose().position.z - height);
        out.lean = out.lean.max(flight.roll().abs());
        let pressure = flight.plant.pressure().into_iter().fold(0.0, f64::max);
        out.pressure = out.pressure.max(pressure);
        if matches!(mode, Mode::Flight | Mode::Contact) {
            out.bump = out.bump.max(pressure);
        }
        out.closed |= mode == Mode::Clamping;
        out.proven |= mode == Mode::Perched;
        if mode == Mode::Clamping {
            out.closing_pressure = out.closing_pressure.max(pressure);
        }
        if ms % CLEARANCE_EVERY == 0 {
            out.clearance = out.clearance.min(flight.plant.propeller_clearance());
        }
        if out.drop > LOST_DEPTH || mode == Mode::Disarmed {
            return Some(out);
        }
        if mode == Mode::Flight && hand.climbs && flight.plant.pose().position.z < height - CLEAR {
            break;
        }
    }
    out.end = match out.mode {
        Mode::Perched => End::Perched,
        _ if hand.perched > touch.stay => End::Released,
        _ => End::Away,
    };
    Some(out)
}

impl Hand {
    fn act(&mut self, flight: &Try, t: f64, touch: &Touch, height: f64) {
        self.display.push_back(flight.stack.mode());
        let shown = if self.display.len() as f64 > REACTION * 1e3 {
            self.display.pop_front()
        } else {
            None
        };
        let pose = flight.plant.pose();
        let slides = flight.roll().abs() > SEEN_LEAN || pose.position.z > height + SEEN_DEPTH;
        let away = matches!(shown, Some(Mode::Escaping | Mode::Failsafe))
            || self.releases && shown == Some(Mode::Flight);
        self.climbs |= away || slides && shown == Some(Mode::Flight);
        if self.climbs {
            self.sticks.perch_switch = false;
            let rate = if pose.position.z > height - 1.0 { 0.7 } else { 0.0 };
            self.sticks.throttle = flight.climb(rate);
            self.sticks.roll = (-0.3 * pose.velocity.y).clamp(-0.4, 0.4) as f32;
            self.sticks.pitch = (0.3 * pose.velocity.x).clamp(-0.4, 0.4) as f32;
            return;
        }
        if t >= touch.cancel && shown != Some(Mode::Perched) {
            self.sticks.perch_switch = false;
        }
        let mut throttle = touch.throttle;
        if shown == Some(Mode::Perched) {
            self.perched += 1e-3;
            throttle = 0.0;
            if self.perched > touch.stay {
                throttle = RELEASE;
                self.releases |= self.sticks.throttle > 0.22;
                self.sticks.perch_switch &= !self.releases;
            }
        } else if self.releases {
            throttle = RELEASE;
        }
        let step = (EASE * 1e-3) as f32;
        self.sticks.throttle += (throttle as f32 - self.sticks.throttle).clamp(-step, step);
    }
}
