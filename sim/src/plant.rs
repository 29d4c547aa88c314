//! The vehicle and its world in `f64`: six degrees of freedom, four soft arms with tip masses, rotors, battery,
//! tendons, contacts.
//!
//! Semi-implicit Euler at 2 kHz: the fastest contact and arm modes are below 50 Hz. Body axes FRD, world NED. Shares
//! with the flight stack only constants of the hardware.

pub mod air;
pub mod battery;
pub mod beam;
pub mod body;
pub mod contact;
pub mod creep;
pub mod esc;
pub mod flexible;
pub mod gauss_markov;
pub mod gust;
pub mod hinged;
pub mod load;
pub mod mass_matrix;
pub mod propeller;
pub mod rotor;
pub mod servo_power;
pub mod tendon;

use glam::{DQuat, DVec3};
use sophie_control::allocation::wrench::PerArm;

use self::air::Air;
use self::battery::Battery;
use self::beam::in_plane::InPlaneSpec;
use self::beam::material::MaterialSpec;
use self::beam::{BeamArm, BeamSpec, Masses};
use self::body::{Body, BodySpec, BodyState};
use self::contact::pipe::Vibration;
use self::contact::{Belly, Pipe, Pose, Surface};
use self::flexible::{Carrier, Drive, Flexible, Nearby};
use self::gust::Gust;
use self::hinged::HingedArm;
use self::hinged::link::{ArmSpec, TIP};
use self::rotor::{Rotor, RotorSpec};
use self::servo_power::MG996R;
use self::tendon::Tendon;
use crate::plant::flexible::ArmBending;
use crate::plant::load::{Acceleration, Load};

/// Integration step, s.
pub const STEP: f64 = 0.5e-3;
/// Gravity, m/s².
pub const GRAVITY: f64 = 9.806_65;
/// Friction of the ground (assumed, TPU on concrete).
const GROUND_FRICTION: f64 = 0.7;
/// Linear air drag, N·s/m (assumed; 0.175 to 0.38 are published, [`air::drag`]).
pub const DRAG: f64 = 0.3;
/// Thrust from which a propeller would break at the pipe, N: a tenth of hover thrust.
const TURNING: f64 = 0.25;
/// Distance of the origin from the pipe within which a disc may reach it, m: arm, disc and a margin.
const STRIKING: f64 = 0.5;
/// Height of the stand's top, m: arms on it touch nothing.
const STAND: f64 = 1.0;
/// Distance of the origin from a surface within which parts may touch it, m: arm, depth of its hinge and a margin.
const NEAR: f64 = 0.25;

/// Inputs from the flight stack.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actuators {
    /// Drive that each controller gives its motor, 0..1.
    pub motors: PerArm<f64>,
    /// Pulse of each servo, µs; 0 without a pulse.
    pub servos: PerArm<f64>,
}

/// Actuators of an arm, and the pressure at its sensor.
#[derive(Clone, Debug)]
struct Limb {
    rotor: Rotor,
    /// That the arm receives, N.
    thrust: f64,
    tendon: Tendon,
    pressure: f64,
}

/// The four arms, all of one model.
#[derive(Clone, Debug)]
enum Arms {
    Hinged(Box<PerArm<HingedArm>>),
    Beams(Box<PerArm<BeamArm>>),
}

/// The vehicle in its world.
#[derive(Clone, Debug)]
pub struct Plant {
    arms: Arms,
    base: Base,
    /// External force at the centre of mass, N, NED.
    pub push: DVec3,
    /// External moment, N·m, body.
    pub moment: DVec3,
    /// Inputs of the last step.
    actuators: Actuators,
}

/// State of the vehicle and its world except the arms.
#[derive(Clone, Debug)]
struct Base {
    body: Body,
    state: BodyState,
    limbs: PerArm<Limb>,
    battery: Battery,
    servo_battery: Battery,
    /// How many times as fast as the motion the slow processes run.
    lapse: f64,
    air: Air,
    gust: Gust,
    ground_belly: Belly,
    pipe_belly: Belly,
    pipe: Pipe,
    vibration: Vibration,
    /// Of belly pads and skin, as [`contact::Pad::rebound`].
    rebound: f64,
    /// Fixed on a stand, away from the pipe.
    on_stand: bool,
    /// Normal force of the pipe on each belly pad, N.
    pad_forces: [f64; 4],
    specific_force: DVec3,
}

/// Parts of the vehicle and its world, as built.
#[derive(Clone, Debug)]
pub struct Parts {
    /// 1, or -1 for rotors that turn the other way round.
    pub chi: f64,
    /// Model of the arms.
    pub bending: ArmBending,
    /// Hinge of each arm.
    pub hinges: PerArm<ArmSpec>,
    /// Beam of each arm, its material and its bending in the plane.
    pub beams: PerArm<BeamSpec>,
    /// Of the beams.
    pub material: MaterialSpec,
    /// Of the beams; `None`: they do not bend in the plane.
    pub in_plane: Option<InPlaneSpec>,
    /// Masses and inertia.
    pub body: BodySpec,
    /// The arms' motion acts on the body.
    pub coupled: bool,
    /// All rotors.
    pub rotor: RotorSpec,
    /// Thrust of each rotor over that of all.
    pub rotor_thrust: PerArm<f64>,
    /// Density of the air, kg/m³.
    pub density: f64,
    /// Each tendon with its servo.
    pub tendons: PerArm<Tendon>,
    /// Flight battery.
    pub battery: Battery,
    /// Servo battery.
    pub servo_battery: Battery,
    /// Wind, drag and what the rotors meet.
    pub air: Air,
    /// Gusts as forces.
    pub gust: Gust,
    /// The pipe and its vibration.
    pub pipe: Pipe,
    /// Of the pipe.
    pub vibration: Vibration,
    /// Coefficient of restitution of belly pads and skin.
    pub restitution: f64,
}

impl Plant {
    /// At rest on the ground at the origin, nose north.
    #[must_use]
    pub fn new(parts: Parts) -> Self {
        let arms = match parts.bending {
            ArmBending::Hinge => Arms::Hinged(Box::new(std::array::from_fn(|i| {
                HingedArm::new(i, parts.hinges[i])
            }))),
            ArmBending::Beam => Arms::Beams(Box::new(std::array::from_fn(|i| {
                BeamArm::new(i, parts.beams[i])
                    .of_material(parts.material)
                    .bending_in_plane(parts.in_plane)
            }))),
        };
        Self {
            arms,
            base: Base::new(parts),
            push: DVec3::ZERO,
            moment: DVec3::ZERO,
            actuators: Actuators::default(),
        }
    }

    /// Inputs of the last step.
    #[must_use]
    pub fn actuators(&self) -> Actuators {
        self.actuators
    }

    /// Lets creep, heat and drift run `factor` times as fast as the motion: a time on the pipe within a minute. The batteries
    /// do not: how long they last is a row of the design check.
    pub fn hasten(&mut self, factor: f64) {
        self.base.lapse = factor;
    }

    /// How many times as fast as the motion the slow processes run.
    #[must_use]
    pub fn lapse(&self) -> f64 {
        self.base.lapse
    }

    /// Advances by [`STEP`].
    pub fn step(&mut self, actuators: &Actuators) {
        self.actuators = *actuators;
        let push = Load {
            force: self.push,
            moment: self.moment,
        };
        match &mut self.arms {
            Arms::Hinged(arms) => self.base.step(arms, actuators, &push),
            Arms::Beams(arms) => self.base.step(arms, actuators, &push),
        }
    }

    /// Moves the vehicle to `position` (m, NED) with `velocity` (m/s, NED), keeping attitude and arms, unseen by its
    /// sensors. For studies.
    pub fn place(&mut self, position: DVec3, velocity: DVec3) {
        self.base.state.pose.position = position;
        self.base.state.pose.velocity = velocity;
    }

    /// Turns the vehicle about the world's vertical by `yaw` (rad, right positive), unseen by its sensors. For studies.
    pub fn turn(&mut self, yaw: f64) {
        let pose = &mut self.base.state.pose;
        let turn = DQuat::from_rotation_z(yaw);
        pose.attitude = turn * pose.attitude;
        pose.velocity = turn * pose.velocity;
    }

    /// Fixes the body level on a stand, where its arms hang free; or puts it back on the ground, at rest.
    pub fn stand(&mut self, on_stand: bool) {
        let base = &mut self.base;
        base.on_stand = on_stand;
        base.state.pose = Pose {
            position: DVec3::new(0.0, 0.0, if on_stand { -STAND } else { -contact::BELLY_Z }),
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        };
    }

    /// Whether it is fixed on a stand.
    #[must_use]
    pub fn stands(&self) -> bool {
        self.base.on_stand
    }

    /// Hangs a weight of `newtons` N on the rotor mount of arm `arm`, 0 to 3; 0 takes it off.
    pub fn hang(&mut self, arm: usize, newtons: f64) {
        match &mut self.arms {
            Arms::Hinged(arms) => arms[arm].hang(newtons),
            Arms::Beams(arms) => arms[arm].hang(newtons),
        }
    }

    /// Gives the pipe another coefficient of friction: it gets wet. For studies.
    pub fn wet(&mut self, friction: f64) {
        self.base.pipe.friction = friction;
    }

    /// Distance of the turning propellers from the pipe, m: negative inside, infinite while none turns.
    #[must_use]
    pub fn propeller_clearance(&self) -> f64 {
        let clear = propeller::clearance(self.pose(), self.tilt(), &self.base.pipe);
        let turning = clear.into_iter().zip(self.thrust());
        turning
            .filter(|(_, thrust)| *thrust > TURNING)
            .fold(f64::INFINITY, |least, (clear, _)| least.min(clear))
    }

    /// Depth of what reaches into each turning propeller's disc, m: of the pipe, and of its own arm.
    #[must_use]
    pub fn struck(&self) -> [PerArm<Option<f64>>; 2] {
        let (tilt, thrust) = (self.tilt(), self.thrust());
        let near = self.base.pipe.gap(self.pose().position) < STRIKING;
        let pipe = if near {
            propeller::clearance(self.pose(), tilt, &self.base.pipe)
        } else {
            [f64::INFINITY; 4]
        };
        [pipe, propeller::own_arm(tilt)].map(|clear| {
            let within = |arm: usize| (thrust[arm] > TURNING && clear[arm] < 0.0).then_some(-clear[arm]);
            std::array::from_fn(within)
        })
    }

    /// Position, attitude and motion.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.base.state.pose
    }

    /// Force of the rotors along the body's thrust axis, N: what a scale under a vehicle on a stand loses.
    #[must_use]
    pub fn lift(&self) -> f64 {
        let arms = self.thrust().into_iter().zip(self.tilt());
        arms.map(|(thrust, tilt)| thrust * libm::cos(tilt)).sum()
    }

    /// Roll, pitch and yaw, rad.
    #[must_use]
    pub fn euler(&self) -> [f64; 3] {
        let q = self.base.state.pose.attitude;
        let (w, x, y, z) = (q.w, q.x, q.y, q.z);
        [
            libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0)),
            libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        ]
    }

    /// At the body's origin, m/s², body.
    #[must_use]
    pub fn specific_force(&self) -> DVec3 {
        self.base.specific_force
    }

    /// Tilt of each arm, rad.
    #[must_use]
    pub fn tilt(&self) -> PerArm<f64> {
        match &self.arms {
            Arms::Hinged(arms) => arms.each_ref().map(Flexible::tilt),
            Arms::Beams(arms) => arms.each_ref().map(Flexible::tilt),
        }
    }

    /// Points of each arm's underside that may touch the pipe, m, body.
    #[must_use]
    pub fn underside(&self) -> PerArm<[DVec3; 3]> {
        match &self.arms {
            Arms::Hinged(arms) => arms.each_ref().map(Flexible::underside),
            Arms::Beams(arms) => arms.each_ref().map(Flexible::underside),
        }
    }

    /// Thrust of each rotor, N.
    #[must_use]
    pub fn thrust(&self) -> PerArm<f64> {
        self.base.limbs.each_ref().map(|l| l.thrust)
    }

    /// Speed of each rotor, rad/s.
    #[must_use]
    pub fn rotor_speed(&self) -> PerArm<f64> {
        self.base.limbs.each_ref().map(|l| l.rotor.speed())
    }

    /// Tension of each tendon at its reel, N.
    #[must_use]
    pub fn tension(&self) -> PerArm<f64> {
        self.base.limbs.each_ref().map(|l| l.tendon.tension())
    }

    /// Torque on each servo's shaft, N·m.
    #[must_use]
    pub fn servo_torque(&self) -> PerArm<f64> {
        self.base.limbs.each_ref().map(|l| l.tendon.servo_torque())
    }

    /// Contact pressure at the sensors, Pa.
    #[must_use]
    pub fn pressure(&self) -> PerArm<f64> {
        self.base.limbs.each_ref().map(|l| l.pressure)
    }

    /// Force with which each belly pad presses on the pipe, in the order of [`Belly::PADS`], N.
    #[must_use]
    pub fn pad_forces(&self) -> [f64; 4] {
        self.base.pad_forces
    }

    /// Battery voltage under load, V.
    #[must_use]
    pub fn battery_voltage(&self) -> f64 {
        self.base.battery.voltage()
    }

    /// Puts in another flight battery of the same make with `charge` (0..1).
    pub fn change_battery(&mut self, charge: f64) {
        self.base.battery = self.base.battery.exchanged(charge);
    }

    /// Voltage of the servo battery under load, V.
    #[must_use]
    pub fn servo_voltage(&self) -> f64 {
        self.base.servo_battery.voltage()
    }

    /// The pipe.
    #[must_use]
    pub fn pipe(&self) -> &Pipe {
        &self.base.pipe
    }

    /// Battery current, A.
    #[must_use]
    pub fn battery_current(&self) -> f64 {
        self.base.battery.current()
    }
}

impl Base {
    fn new(parts: Parts) -> Self {
        let rebound = contact::rebound(parts.restitution);
        let body = match parts.bending {
            _ if !parts.coupled => Body::whole(&parts.body),
            ArmBending::Hinge => Body::new(&parts.body, &TIP),
            ArmBending::Beam => Body::new(&parts.body, &Masses::of(&parts.body).points()),
        };
        let limb = |i: usize| Limb {
            rotor: Rotor::new(i, parts.chi, parts.rotor).in_air(parts.rotor_thrust[i], parts.density),
            thrust: 0.0,
            tendon: parts.tendons[i].clone(),
            pressure: 0.0,
        };
        Self {
            body,
            state: BodyState {
                pose: Pose {
                    position: DVec3::new(0.0, 0.0, -contact::BELLY_Z),
                    attitude: DQuat::IDENTITY,
                    velocity: DVec3::ZERO,
                    omega: DVec3::ZERO,
                },
            },
            limbs: std::array::from_fn(limb),
            battery: parts.battery,
            servo_battery: parts.servo_battery,
            lapse: 1.0,
            air: parts.air,
            gust: parts.gust,
            ground_belly: Belly::default().rebounding(rebound),
            pipe_belly: Belly::default().rebounding(rebound),
            pipe: parts.pipe,
            vibration: parts.vibration,
            rebound,
            on_stand: false,
            pad_forces: [0.0; 4],
            specific_force: DVec3::new(0.0, 0.0, -GRAVITY),
        }
    }

    /// Advances by [`STEP`] under `push`, a force in NED and a moment in body axes.
    fn step<A: Flexible>(&mut self, arms: &mut PerArm<A>, actuators: &Actuators, push: &Load) {
        let pose = self.state.pose;
        let gravity = pose.to_body(DVec3::new(0.0, 0.0, GRAVITY));
        let (mut load, nearby) = self.outside(push);
        let carrier = Carrier {
            omega: pose.omega,
            gravity,
            coupled: self.body.coupled(),
        };
        let voltage = self.battery.voltage();
        let (mut current, mut servo_current) = (0.0, 0.0);
        let powered = !self.servo_battery.empty();
        let rotors = self.limbs.each_ref().map(|limb| &limb.rotor);
        let tilt = arms.each_ref().map(Flexible::tilt);
        let in_air = self.air.on_rotors(&pose, tilt, rotors, &self.pipe, &mut load);
        let commands = actuators.motors.iter().zip(&actuators.servos).zip(in_air);
        for ((limb, arm), ((motor, servo), in_air)) in
            self.limbs.iter_mut().zip(arms.iter_mut()).zip(commands)
        {
            limb.thrust = limb.rotor.step(STEP, *motor, voltage) * in_air;
            current += limb.rotor.current(voltage);
            // Without supply the servo behaves as without a pulse: the gears hold by friction.
            let servo = if powered { *servo } else { 0.0 };
            if servo > 0.0 {
                servo_current += MG996R.at(limb.tendon.servo_torque());
            }
            let drive = Drive {
                dt: STEP,
                slow: self.lapse * STEP,
                thrust: limb.thrust,
                tendon: limb.tendon.step(STEP, self.lapse, servo, arm.tilt()),
                momentum: limb.rotor.momentum(),
                drag: limb.rotor.drag(),
            };
            limb.pressure = arm.touch(STEP, &pose, &nearby, &mut load);
            arm.drive(&drive, &carrier, &mut load);
        }
        self.battery.step(STEP, current);
        self.servo_battery.step(STEP, servo_current);

        let acceleration = if self.on_stand {
            Acceleration::ZERO
        } else {
            self.body.accelerate(&pose, load, gravity, arms.each_ref())
        };
        self.specific_force = acceleration.linear - gravity;
        for arm in arms {
            arm.advance(STEP, &acceleration, &carrier);
        }
        let pose = &mut self.state.pose;
        pose.velocity += pose.attitude * acceleration.linear * STEP;
        pose.omega += acceleration.angular * STEP;
        pose.position += pose.velocity * STEP;
        let h = pose.omega * (0.5 * STEP);
        pose.attitude = (pose.attitude * DQuat::from_xyzw(h.x, h.y, h.z, 1.0)).normalize();
    }

    /// External forces on the body, to which the solver adds gravity, and what the arms may touch.
    fn outside(&mut self, push: &Load) -> (Load, Nearby) {
        let pose = self.state.pose;
        let mut load = Load {
            force: pose.to_body(push.force + self.air.on_body(&pose, &self.pipe) + self.gust.force()),
            moment: self.gust.moment() + push.moment,
        };
        self.gust.step(STEP);
        self.air.step(STEP, &self.pipe);
        let ground = pose.position.z > -NEAR;
        if ground {
            let surface = Surface::Ground(GROUND_FRICTION);
            let belly = self.ground_belly.step(STEP, &pose, &surface);
            load.add(belly.force_body, belly.moment_body);
        }
        self.vibration.step(STEP, &mut self.pipe.shape);
        let across = self.pipe.across(pose.position);
        let near = !self.on_stand && across.length() < self.pipe.largest_radius() + NEAR;
        self.pad_forces = [0.0; 4];
        if near {
            let belly = self.pipe_belly.step(STEP, &pose, &Surface::Pipe(self.pipe));
            self.pad_forces = belly.normal;
            load.add(belly.force_body, belly.moment_body);
        }
        let pipe = near.then_some(self.pipe);
        let rebound = self.rebound;
        (
            load,
            Nearby {
                pipe,
                ground,
                rebound,
            },
        )
    }
}
