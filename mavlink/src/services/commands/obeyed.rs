//! The supported commands and their conditions, as docs/mavlink.md lists them.

use sophie_dialect::MavCmd;

/// Condition of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In every state.
    Always,
    /// At rest: DISARMED and CALIBRATING.
    AtRest,
    /// If the commander agrees, under these conditions.
    Commander(&'static str),
}

/// A command in one of its forms.
#[derive(Clone, Copy, Debug)]
pub struct Obeyed {
    /// The command.
    pub command: MavCmd,
    /// Its parameters and their effect.
    pub form: &'static str,
    /// Its condition.
    pub when: When,
}

const fn obeyed(command: MavCmd, form: &'static str, when: When) -> Obeyed {
    Obeyed { command, form, when }
}

/// Every supported command. These texts are not in the image.
pub const OBEYED: [Obeyed; 21] = [
    obeyed(
        MavCmd::MAV_CMD_REQUEST_MESSAGE,
        "message (of the modes: which, 0 all)",
        When::Always,
    ),
    obeyed(
        MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
        "message, us (0 its own, -1 never)",
        When::Always,
    ),
    obeyed(MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL, "message", When::Always),
    obeyed(
        MavCmd::MAV_CMD_PREFLIGHT_STORAGE,
        "1 (store parameters)",
        When::AtRest,
    ),
    obeyed(
        MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
        "1 (restart)",
        When::AtRest,
    ),
    obeyed(
        MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION,
        "which, below",
        When::AtRest,
    ),
    obeyed(
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        "1 (arm)",
        When::Commander("DISARMED, with the radio there, its arm switch on and every arming check passing"),
    ),
    obeyed(
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        "0 (disarm)",
        When::Commander("on the ground; PERCHED with the arm switch off"),
    ),
    obeyed(
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        "0, 21196 (force)",
        When::Always,
    ),
    obeyed(
        MavCmd::MAV_CMD_DO_GRIPPER,
        "1, 1 (grab)",
        When::Commander("where the perch switch does it, below"),
    ),
    obeyed(
        MavCmd::MAV_CMD_DO_GRIPPER,
        "1, 0 (release)",
        When::Commander("the same"),
    ),
    obeyed(
        MavCmd::MAV_CMD_USER_1,
        "1 (the propellers are off)",
        When::Commander("DISARMED; counts until the next arming or restart"),
    ),
    obeyed(
        MavCmd::MAV_CMD_USER_1,
        "2 (the vehicle is tied down, propellers on)",
        When::Commander("the same"),
    ),
    obeyed(
        MavCmd::MAV_CMD_SOPHIE_STATIC_THRUST,
        "rotor (0 all), percent, other percent, seconds, run",
        When::Commander(
            "as the console's `thrust`: DISARMED, said to be tied down, battery above critical; ends when it is not sent again \
             for 1.5 s, or when the vehicle turns by 15 degrees; 0 % stops",
        ),
    ),
    obeyed(
        MavCmd::MAV_CMD_DO_MOTOR_TEST,
        "motor, 0, percent, seconds",
        When::Commander(
            "as the console's `motor`: DISARMED, propellers said to be off, 2 to 12 %, two seconds at most; 0 % stops",
        ),
    ),
    obeyed(
        MavCmd::MAV_CMD_DO_MOTOR_TEST,
        "motor, 1, us, seconds",
        When::Commander("the same by a pulse, which may be below the one that turns every motor"),
    ),
    obeyed(
        MavCmd::MAV_CMD_DO_SET_SERVO,
        "5 to 8, us",
        When::Commander("as the console's `servo`: DISARMED, arms open, 30 s at most; 0 us gives it back"),
    ),
    obeyed(
        MavCmd::MAV_CMD_SOPHIE_CALIBRATE,
        "calibration (0 ends), part, step, values",
        When::AtRest,
    ),
    obeyed(MavCmd::MAV_CMD_SOPHIE_REPORT, "1 (self-test)", When::AtRest),
    obeyed(MavCmd::MAV_CMD_SOPHIE_REPORT, "2 (chip)", When::Always),
    obeyed(
        MavCmd::MAV_CMD_SOPHIE_SET_BROWN_OUT,
        "1 (set the chip's brown-out level and restart)",
        When::AtRest,
    ),
];
