//! The warnings on the page of what the display says, each with what he is to do.

use sophie_control::navigation::flow_range::FlowRangeFault;
use sophie_control::navigation::flow_range::FlowRangeLimit;
use std::fmt::Write;

use sophie_control::battery::ServoSupply;
use sophie_control::navigation::{external_pose::PoseFault, position_estimator::Fault};
use sophie_ports::retained::StartCause;
use sophie_tasks::pilot::warning::Warning;

fn to_do(warning: Warning) -> &'static str {
    match warning {
        Warning::AccelClips => {
            "It reads no further than `imu_accel_range`, and its attitude is the gyro's alone. Land; look for a bent propeller, a loose motor or board ([limits](design/inertial-sensor.md))."
        }
        Warning::Vibrates => {
            "No perch; land. `status` shows it: balance the propellers, look for a loose motor or board ([vibration](calibration.md#vibration))."
        }
        Warning::Stack => "Land. Do not fly this image: report what `silicon` and the log say of its stack.",
        Warning::ArmTilt => {
            "Land; `infill`, `gain_k` and the arm's sensor ([calibration](calibration.md#arms))."
        }
        Warning::Servos(ServoSupply::NearEnd) => "Perched: let go within the minute. Else no long perch.",
        Warning::Servos(ServoSupply::Low) => {
            "No perch; land, charge it. Perched: let go now, while the servos can open the arms."
        }
        Warning::Servos(ServoSupply::Silent) => {
            "No perch; land. Its lead, `servo_batt_div`. Perched: let go."
        }
        Warning::Servos(ServoSupply::NotFitted | ServoSupply::Good) => "",
        Warning::Restarted(StartCause::PowerOn | StartCause::Software) => "",
        Warning::Restarted(StartCause::BrownOut) => {
            "Do not fly: find why the supply broke down; power off and on."
        }
        Warning::Restarted(StartCause::Watchdog) => "Do not fly before the log says which task stood still.",
        Warning::Restarted(StartCause::Fault) => {
            "Do not fly before the log's `previous run ended with` is understood."
        }
        Warning::Position(Fault::Pose(PoseFault::Frozen)) => "Steer it, land; start the pose's sender again.",
        Warning::Position(Fault::Pose(PoseFault::Jumps)) => {
            "Steer it; it holds again once the pose is sound. Land where that comes back."
        }
        Warning::Position(Fault::Pose(PoseFault::Disagrees)) => {
            "Steer it, land; the sender's axes, heading and scale ([holding](position-sources.md#external-poses))."
        }
        Warning::Position(Fault::FlowRange(FlowRangeFault::FlowDisagrees)) => {
            "Steer it, land; `flow_mounting`, `flow_scale`, the module's place ([holding](position-sources.md#flow-and-range))."
        }
        Warning::Position(Fault::FlowRange(FlowRangeFault::FlowFrozen | FlowRangeFault::RangeFrozen)) => {
            "Steer it, land: a new module."
        }
        Warning::Position(Fault::FlowRange(FlowRangeFault::RangeJumps)) => {
            "Steer it away from what is rough below; look at the lens."
        }
        Warning::Position(Fault::FlowRange(FlowRangeFault::RangeInconsistent)) => {
            "Steer it; the height begins anew after 5 s. Land if it comes back; look at the lens."
        }
        Warning::Position(Fault::FlowRange(FlowRangeFault::RangeScaled)) => {
            "Steer it, land; the module's unit of length. It counts again once it has climbed as far as the vehicle."
        }
        Warning::Position(Fault::Pressure(_)) => {
            "Go on: it counts where pose or range are lost alone. Foam over the barometer, or a new board."
        }
        Warning::Limit(FlowRangeLimit::TooLow | FlowRangeLimit::TooHigh) => {
            "Fly within 8 cm to 2.5 m of what is below, or by hand."
        }
        Warning::Limit(FlowRangeLimit::NoRange) => "Come down, or off the edge.",
        Warning::Limit(FlowRangeLimit::TooDark) => "By hand: more light, a floor with a pattern.",
        Warning::ServoWeak => {
            "`servo_torque_max` is above what `servo_stall` gives: a full grip may not hold."
        }
        Warning::InfillLow => "Arms softer than any that flew: stay low.",
    }
}

#[test]
fn every_warning_is_on_the_page_of_the_display() {
    let mut table = String::from("| warning | what to do |\n|---|---|\n");
    for warning in Warning::ALL {
        let _ = writeln!(table, "| {} | {} |", warning.text(), to_do(warning));
    }
    let test = "--package sophie-tasks --test tasks pilot_page";
    sophie_pages::hold("display", &[("warnings", table)], test);
}

#[test]
fn every_start_that_warns_is_among_the_warnings() {
    for cause in [
        StartCause::PowerOn,
        StartCause::Software,
        StartCause::BrownOut,
        StartCause::Watchdog,
        StartCause::Fault,
    ] {
        let warning = Warning::Restarted(cause);
        assert_eq!(
            Warning::ALL.contains(&warning),
            !warning.text().is_empty(),
            "{cause:?}"
        );
    }
}
