//! Tells of a proven grip, arm by arm: what the clamp loop measured when it was proven.

use sophie_tasks::links::Links;

/// Tells once for each grip.
#[derive(Default)]
pub struct GripReport {
    proven: bool,
}

impl GripReport {
    /// Looks at the grip.
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
