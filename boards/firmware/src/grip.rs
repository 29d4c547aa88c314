//! Logs a proven grip: the clamp loop's measurements per arm at the proof.

use sophie_tasks::links::Links;

/// Logs each grip once.
#[derive(Default)]
pub struct GripReport {
    proven: bool,
}

impl GripReport {
    pub fn look(&mut self, links: &Links) {
        let Some(grip) = links.grip.latest().map(|g| g.value) else {
            return;
        };
        if grip.proven && !self.proven {
            for (arm, number) in grip.arms.iter().zip(1u8..) {
                if let Some(closure) = arm.closure {
                    defmt::info!(
                        "grip: arm {=u8} holds {=f32} N/m2 with {=f32} N, closed in {=f32} s",
                        number,
                        arm.pressure,
                        arm.force,
                        closure
                    );
                }
            }
            defmt::info!("grip proven");
        }
        self.proven = grip.proven;
    }
}
