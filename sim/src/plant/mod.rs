//! The vehicle and its world in `f64`: six degrees of freedom, four soft arms with tip masses, rotors, battery,
//! tendons, contacts.
//!
//! Semi-implicit Euler at 2 kHz: the fastest contact and arm modes are below 30 Hz. Body axes FRD, world NED. Shares
//! with the flight stack only constants of the hardware.

pub mod arm;
pub mod battery;
pub mod body;
pub mod contact;
pub mod gust;
pub mod propeller;
pub mod rotor;
pub mod servo_power;
pub mod tendon;

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64Mcg;
use sophie_control::wrench::PerArm;

use self::arm::{Arm, ArmPrint, ArmSpec};
use self::battery::Battery;
use self::body::{Body, BodyState, Load};
use self::contact::{ArmSkin, ArmTip, Belly, Pipe, Pose, Surface};
use self::gust::Gust;
use self::rotor::Rotor;
use self::tendon::{ServoSpec, Tendon, TendonSpec};
use crate::scenario::{Scenario, Vehicle};

/// Integration step, s.
pub const STEP: f64 = 0.5e-3;
/// Gravity, m/s².
pub const GRAVITY: f64 = 9.806_65;
/// Friction of the ground (assumed, TPU on concrete).
const GROUND_FRICTION: f64 = 0.7;
/// Linear air drag, N·s/m (assumed).
pub const DRAG: f64 = 0.3;
/// Thrust of a propeller that would break at the pipe, N: a tenth of what it hovers with.
const TURNING: f64 = 0.25;
/// Distance of the origin from a surface within which parts may touch it, m: arm, depth of its hinge and a margin.
const NEAR: f64 = 0.25;

/// Inputs from the flight stack.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actuators {
    /// Command of each motor, 0..1.
    pub motors: PerArm<f64>,
    /// Pulse of each servo, µs; 0 is none.
    pub servos: PerArm<f64>,
}

#[derive(Clone, Debug)]
struct Limb {
    arm: Arm,
    rotor: Rotor,
    tendon: Tendon,
    skin: ArmSkin,
    tip: ArmTip,
    pressure: f64,
}

/// The vehicle in its world.
#[derive(Clone, Debug)]
pub struct Plant {
    body: Body,
    state: BodyState,
    limbs: PerArm<Limb>,
    battery: Battery,
    gust: Gust,
    ground_belly: Belly,
    pipe_belly: Belly,
    pipe: Pipe,
    coupled: bool,
    /// External force at the centre of mass, N, NED.
    pub push: DVec3,
    /// External moment, N·m, body.
    pub moment: DVec3,
    specific_force: DVec3,
}

/// Arm `arm` (0 to 3) of `vehicle` as built.
#[must_use]
pub fn arm_spec(vehicle: &Vehicle, arm: usize) -> ArmSpec {
    let v = vehicle;
    ArmSpec::of(&ArmPrint {
        coefficients: v.arm_coefficients,
        infill: v.infill,
        gain_k: v.gain_k,
        gain: v.arm_gain[arm],
        offset: v.arm_offset[arm],
        zeta: v.arm_damping,
    })
    .level_at(v.arm_level_share * v.rotor.thrust_max)
}

impl Plant {
    /// At rest on the ground at the origin, nose north.
    #[must_use]
    pub fn new(scenario: &Scenario, rng: Pcg64Mcg) -> Self {
        let (v, w) = (&scenario.vehicle, &scenario.world);
        let chi = f64::from(v.configuration.chi());
        let radius = 0.5 * w.pipe_diameter;
        let limb = |i: usize| Limb {
            arm: Arm::new(i, arm_spec(v, i)),
            rotor: Rotor::new(i, chi, v.rotor),
            tendon: Tendon::new(
                ServoSpec::from(v.servo).measured(&scenario.params, i),
                TendonSpec::default(),
            ),
            skin: ArmSkin::new(i),
            tip: ArmTip::new(i),
            pressure: 0.0,
        };
        Self {
            body: Body::new(&v.body, v.coupled_arms),
            state: BodyState {
                pose: Pose {
                    position: DVec3::new(0.0, 0.0, -contact::BELLY_Z),
                    attitude: DQuat::IDENTITY,
                    velocity: DVec3::ZERO,
                    omega: DVec3::ZERO,
                },
            },
            limbs: std::array::from_fn(limb),
            battery: Battery::new(v.battery_charge),
            gust: Gust::new(w.gust_force, w.gust_moment, rng),
            ground_belly: Belly::default(),
            pipe_belly: Belly::default(),
            pipe: Pipe {
                north: w.pipe_position[0],
                half_length: 1.0,
                east: w.pipe_position[1],
                down: -w.pipe_top + radius,
                radius,
                friction: w.pipe_friction,
            },
            coupled: v.coupled_arms,
            push: DVec3::ZERO,
            moment: DVec3::ZERO,
            specific_force: DVec3::new(0.0, 0.0, -GRAVITY),
        }
    }

    /// Advances by [`STEP`].
    pub fn step(&mut self, actuators: &Actuators) {
        let pose = self.state.pose;
        let voltage = self.battery.voltage();
        let gravity_body = pose.to_body(DVec3::new(0.0, 0.0, GRAVITY));

        // External forces on the body: the solver adds gravity.
        let mut load = Load {
            force: pose.to_body(self.push - pose.velocity * DRAG + self.gust.force()),
            moment: self.gust.moment() + self.moment,
        };
        self.gust.step(STEP);
        let near_ground = pose.position.z > -NEAR;
        if near_ground {
            let surface = Surface::Ground(GROUND_FRICTION);
            let belly = self.ground_belly.step(STEP, &pose, &surface);
            load.add(belly.force_body, belly.moment_body);
        }
        let across = pose.position - DVec3::new(pose.position.x, self.pipe.east, self.pipe.down);
        let near_pipe = across.length_squared() < (self.pipe.radius + NEAR).powi(2);
        if near_pipe {
            let belly = self.pipe_belly.step(STEP, &pose, &Surface::Pipe(self.pipe));
            load.add(belly.force_body, belly.moment_body);
        }

        let mut current = 0.0;
        let commands = actuators.motors.iter().zip(&actuators.servos);
        for (limb, (motor, servo)) in self.limbs.iter_mut().zip(commands) {
            let thrust = limb.rotor.step(STEP, *motor, voltage);
            current += limb.rotor.current(voltage);
            let (alpha, alpha_rate) = (limb.arm.tilt, limb.arm.rate);
            let mut moment_alpha = limb.tendon.step(STEP, *servo, alpha);
            limb.pressure = 0.0;
            if near_pipe {
                let skin = limb.skin.step(STEP, alpha, alpha_rate, &pose, &self.pipe);
                load.add(skin.force_body, skin.moment_body);
                moment_alpha += skin.moment_alpha;
                limb.pressure = skin.pressure;
            }
            if near_ground {
                let tip = limb.tip.step(STEP, alpha, alpha_rate, &pose);
                load.add(tip.force_body, tip.moment_body);
                moment_alpha += tip.moment_alpha;
            }
            load.moment += limb.rotor.drag_moment(limb.arm.normal());
            limb.arm.load(thrust, moment_alpha, gravity_body, self.coupled);
        }
        self.battery.step(STEP, current);

        let arms = self.limbs.each_ref().map(|l| &l.arm);
        let acceleration = self.body.accelerate(&pose, load, gravity_body, arms);
        self.specific_force = acceleration.linear - gravity_body;
        for (limb, alpha_acceleration) in self.limbs.iter_mut().zip(acceleration.arms) {
            limb.arm.integrate(STEP, alpha_acceleration);
        }
        let pose = &mut self.state.pose;
        pose.velocity += pose.attitude * acceleration.linear * STEP;
        pose.omega += acceleration.angular * STEP;
        pose.position += pose.velocity * STEP;
        let h = pose.omega * (0.5 * STEP);
        pose.attitude = (pose.attitude * DQuat::from_xyzw(h.x, h.y, h.z, 1.0)).normalize();
    }

    /// Moves the vehicle to `position` (m, NED) with `velocity` (m/s, NED), keeping attitude and arms, unseen by its
    /// sensors. For studies.
    pub fn place(&mut self, position: DVec3, velocity: DVec3) {
        self.state.pose.position = position;
        self.state.pose.velocity = velocity;
    }

    /// Turns the vehicle about the world's vertical by `yaw` (rad, right positive), unseen by its sensors. For studies.
    pub fn turn(&mut self, yaw: f64) {
        let pose = &mut self.state.pose;
        pose.attitude = DQuat::from_rotation_z(yaw) * pose.attitude;
        pose.velocity = DQuat::from_rotation_z(yaw) * pose.velocity;
    }

    /// Distance of the turning propellers from the pipe, m: negative inside, infinite while none turns.
    #[must_use]
    pub fn propeller_clearance(&self) -> f64 {
        let clear = propeller::clearance(&self.state.pose, self.tilt(), &self.pipe);
        let turning = clear.into_iter().zip(self.thrust());
        turning
            .filter(|(_, thrust)| *thrust > TURNING)
            .fold(f64::INFINITY, |least, (clear, _)| least.min(clear))
    }

    /// Position, attitude and motion.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.state.pose
    }

    /// Roll, pitch and yaw, rad.
    #[must_use]
    pub fn euler(&self) -> [f64; 3] {
        let q = self.state.pose.attitude;
        let (w, x, y, z) = (q.w, q.x, q.y, q.z);
        [
            (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y)),
            (2.0 * (w * y - z * x)).clamp(-1.0, 1.0).asin(),
            (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
        ]
    }

    /// At the body's origin, m/s², body.
    #[must_use]
    pub fn specific_force(&self) -> DVec3 {
        self.specific_force
    }

    /// Tilt of each arm, rad.
    #[must_use]
    pub fn tilt(&self) -> PerArm<f64> {
        self.limbs.each_ref().map(|l| l.arm.tilt)
    }

    /// Thrust of each rotor, N.
    #[must_use]
    pub fn thrust(&self) -> PerArm<f64> {
        self.limbs.each_ref().map(|l| l.rotor.thrust())
    }

    /// Speed of each rotor, rad/s.
    #[must_use]
    pub fn rotor_speed(&self) -> PerArm<f64> {
        self.limbs.each_ref().map(|l| l.rotor.speed())
    }

    /// Tension of each tendon, N.
    #[must_use]
    pub fn tension(&self) -> PerArm<f64> {
        self.limbs.each_ref().map(|l| l.tendon.tension())
    }

    /// Contact pressure at the sensors, Pa.
    #[must_use]
    pub fn pressure(&self) -> PerArm<f64> {
        self.limbs.each_ref().map(|l| l.pressure)
    }

    /// Battery voltage under load, V.
    #[must_use]
    pub fn battery_voltage(&self) -> f64 {
        self.battery.voltage()
    }

    /// Battery current, A.
    #[must_use]
    pub fn battery_current(&self) -> f64 {
        self.battery.current()
    }
}
