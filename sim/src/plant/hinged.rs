//! The paper's arm model: a rigid link on one hinge, with its contacts.

pub mod link;

use glam::DVec3;

use self::link::{Arm, ArmSpec};
use super::GRAVITY;
use super::contact::{ARM_LENGTH, ArmSkin, ArmTip, Pose, STATIONS};
use super::flexible::{Carried, Carrier, Drive, Flexible, Nearby};
use super::mass_matrix::MassMatrix;
use crate::plant::load::Acceleration;
use crate::plant::load::Load;

/// An arm on one hinge, its underside and its tip.
#[derive(Clone, Debug)]
pub struct HingedArm {
    arm: Arm,
    skin: ArmSkin,
    tip: ArmTip,
    /// Contact moment of underside and tip on the tilt, N·m.
    contact: [f64; 2],
    /// Weight on the tip, N.
    hung: f64,
}

impl HingedArm {
    /// Arm `index`, 0 to 3, at rest without thrust.
    #[must_use]
    pub fn new(index: usize, spec: ArmSpec) -> Self {
        Self {
            arm: Arm::new(index, spec),
            skin: ArmSkin::new(index),
            tip: ArmTip::new(index),
            contact: [0.0; 2],
            hung: 0.0,
        }
    }
}

impl Carried for HingedArm {
    fn condense(&self, carrier: &Carrier, mass: &mut MassMatrix, load: &mut Load) {
        self.arm.condense(carrier, mass, load);
    }

    fn condense_massless(&self, load: &mut Load) {
        self.arm.condense_massless(load);
    }
}

impl Flexible for HingedArm {
    fn tilt(&self) -> f64 {
        self.arm.tilt
    }

    fn underside(&self) -> [DVec3; 3] {
        STATIONS.map(|station| self.skin.point(self.arm.tilt, station).0)
    }

    fn hang(&mut self, newtons: f64) {
        self.hung = newtons;
    }

    fn touch(&mut self, dt: f64, pose: &Pose, nearby: &Nearby, load: &mut Load) -> f64 {
        let (tilt, rate) = (self.arm.tilt, self.arm.rate);
        self.contact = [0.0; 2];
        let mut pressure = 0.0;
        if let Some(pipe) = &nearby.pipe {
            let skin = self.skin.step(dt, tilt, rate, pose, pipe);
            load.add(skin.force_body, skin.moment_body);
            self.contact[0] = skin.moment_alpha;
            pressure = skin.pressure;
        }
        if nearby.ground {
            let tip = self.tip.step(dt, tilt, rate, pose);
            load.add(tip.force_body, tip.moment_body);
            self.contact[1] = tip.moment_alpha;
        }
        pressure
    }

    // The hinge has neither torsion nor a rotor's angular momentum.
    fn drive(&mut self, drive: &Drive, carrier: &Carrier, load: &mut Load) {
        let [skin, tip] = self.contact;
        load.moment += self.arm.normal() * drive.drag;
        let mut moment = drive.tendon + skin + tip;
        if self.hung != 0.0 {
            moment += self.hung / GRAVITY * ARM_LENGTH * self.arm.normal().dot(carrier.gravity);
        }
        self.arm
            .load(drive.thrust, moment, carrier.gravity, carrier.coupled);
    }

    fn advance(&mut self, dt: f64, body: &Acceleration, carrier: &Carrier) {
        self.arm.integrate(dt, self.arm.acceleration(body, carrier));
    }
}
