//! The table: a line a parameter. A number has `name = default, "unit", least ..= most;`, an enumerated parameter
//! `name: Type = default, "unit";`.

use super::ParamInfo;
use super::choices::{
    ArmBusSpeed, ArmSign, FlowMounting, FlowPort, ImuAccelRange, ImuGyroRange, ImuMounting, ImuRate,
    MotorMap, MotorProtocol, RcProtocol, ServoMarks, Value,
};
use super::names::check_names;

macro_rules! params {
    (@type) => { f32 };
    (@type $type:ident) => { $type };
    (@number $number:expr) => { $number };
    (@number $default:expr, $type:ident) => { $default.number() };
    (@min $min:literal) => { $min };
    (@min , $type:ident) => { $type::MIN };
    (@max $max:literal) => { $max };
    (@max , $type:ident) => { $type::MAX };
    (@choices) => { &[] };
    (@choices $type:ident) => { $type::CHOICES };
    ($( $(#[doc = $doc:literal])+ $name:ident $(: $type:ident)? = $default:expr, $unit:literal
        $(, $min:literal ..= $max:literal)?; )+) => {
        /// The parameters of one vehicle; `Default` is the paper's vehicle.
        #[derive(Clone, Copy, Debug)]
        pub struct Params {
            $( $(#[doc = $doc])+ pub $name: params!(@type $($type)?), )+
        }

        impl Default for Params {
            fn default() -> Self {
                Self::DEFAULT
            }
        }

        const _: () = check_names(&[$( stringify!($name) ),+]);

        /// The rows' places in the table.
        #[allow(non_camel_case_types, reason = "the names of the parameters")]
        #[repr(usize)]
        enum Place { $( $name ),+ }

        /// One place in the image, where a constant would be copied into every crate that looks at it.
        pub(super) static ROWS: [ParamInfo; [$( stringify!($name) ),+].len()] = [
            $( ParamInfo {
                name: stringify!($name),
                unit: $unit,
                min: params!(@min $($min)? $(, $type)?),
                max: params!(@max $($max)? $(, $type)?),
                choices: params!(@choices $($type)?),
                default: params!(@number $default $(, $type)?),
            }, )+
        ];

        /// The descriptions, apart from the rows: an image has them in its parameter file alone.
        pub(super) static DOCS: [&str; ROWS.len()] = [$( concat!($($doc),+) ),+];

        impl Params {
            /// The table's defaults; a board may have others for what is soldered to it.
            pub const DEFAULT: Self = Self { $( $name: $default, )+ };

            /// The whole table, in the order of the fields.
            pub const TABLE: &'static [ParamInfo] = &ROWS;

            /// Every value, in the order of the table.
            pub(super) fn values(&self) -> [f32; ROWS.len()] {
                [$( self.$name.to_number() ),+]
            }

            /// Sets the value of row `at`; `None` where there is no such row, or no such choice.
            pub(super) fn put(&mut self, at: usize, value: f32) -> Option<()> {
                $( if at == Place::$name as usize {
                    self.$name = Value::from_number(value)?;
                    return Some(());
                } )+
                None
            }
        }
    };
}

params! {
    /// Mass of the vehicle (paper, Table II).
    mass = 1.805, "kg", 0.5 ..= 5.0;
    /// Roll inertia (assumed, 30 %).
    inertia_roll = 0.021, "kg m2", 0.002 ..= 0.2;
    /// Pitch inertia (assumed, 30 %).
    inertia_pitch = 0.044, "kg m2", 0.002 ..= 0.2;
    /// Yaw inertia (assumed, 30 %).
    inertia_yaw = 0.063, "kg m2", 0.002 ..= 0.4;
    /// Sideways distance of a rotor from the centre line (derived from L/D >= 1.4 with 10-inch propellers).
    arm_d = 0.178, "m", 0.05 ..= 0.5;
    /// Fore-aft distance of a rotor from the centre (derived, square layout).
    arm_b = 0.178, "m", 0.05 ..= 0.5;
    /// Largest thrust of a rotor (assumed from the paper's 450 g nominal and hover at half throttle).
    thrust_max = 8.3, "N", 2.0 ..= 30.0;
    /// Thrust of a rotor that idles while armed (assumed).
    thrust_idle = 0.25, "N", 0.05 ..= 1.0;
    /// Rotor drag torque over thrust, C_Q/C_T (assumed, 0.002).
    torque_ratio = 0.016, "m", 0.005 ..= 0.05;
    /// Time constant of motor and propeller (of slow motors, until `sophie bringup` finds yours). Above 0.05 s roll and pitch
    /// are led by it: see Slow motors in docs/tuning.md.
    motor_tau = 0.1, "s", 0.005 ..= 0.3;
    /// Share of the thrust that grows with the square of the command; the rest is linear (assumed; of your own rotors from
    /// `bringup --again thrust`).
    thrust_curve = 0.75, "1", 0.0 ..= 1.0;
    /// Power of the battery's voltage with which the thrust at a command goes (assumed, that of a motor without losses).
    thrust_volt_exp = 2.0, "1", 1.0 ..= 2.5;
    /// Thrust of rotor 1 at a command over the mean of the four.
    thrust_trim_1 = 1.0, "1", 0.7 ..= 1.3;
    /// Thrust of rotor 2 at a command over the mean of the four.
    thrust_trim_2 = 1.0, "1", 0.7 ..= 1.3;
    /// Thrust of rotor 3 at a command over the mean of the four.
    thrust_trim_3 = 1.0, "1", 0.7 ..= 1.3;
    /// Thrust of rotor 4 at a command over the mean of the four.
    thrust_trim_4 = 1.0, "1", 0.7 ..= 1.3;

    /// Motor protocol: 150, 300 or 600 for DShot, 400 for pulses, at most 400 a second, 125 for OneShot125.
    /// Read by the board at start-up; the paper's controllers take 400.
    motor_protocol: MotorProtocol = MotorProtocol::Dshot300, "1";
    /// Pulse that stops a motor; OneShot125 takes an eighth.
    motor_pulse_min = 1000.0, "us", 800.0 ..= 1500.0;
    /// Lowest pulse at which every rotor turns (`motor N US us`).
    motor_pulse_idle = 1070.0, "us", 800.0 ..= 2200.0;
    /// Pulse of full drive.
    motor_pulse_max = 2000.0, "us", 1200.0 ..= 2200.0;
    /// Which rotor hangs at each motor output (`motor N`): its four digits, each of 1 to 4 once, are the rotors at outputs 1
    /// to 4; 1243 where the wires of 3 and 4 are swapped.
    motor_map: MotorMap = MotorMap::STRAIGHT, "1";
    /// Receiver: 0 for CRSF at 420 kbaud, 1 for SBUS. Read by the board at start-up.
    rc_protocol: RcProtocol = RcProtocol::Crsf, "1";
    /// Module of optical flow and range: 0 for none, 1 for one that speaks MSP version 2. Read by the board at start-up.
    flow_port: FlowPort = FlowPort::Closed, "1";
    /// Where the x axis of the flow module points, clockwise from above. Read by the board at start-up.
    flow_mounting: FlowMounting = FlowMounting::Forward, "deg";
    /// Counts of the flow module for each degree that it turns, as INAV's `opflow_scale`. Read by the board at start-up.
    flow_scale = 10.5, "1/deg", 0.5 ..= 200.0;
    /// Lens of the flow module ahead of the vehicle's centre of mass, measured with a ruler.
    flow_x = 0.0, "m", -0.3 ..= 0.3;
    /// Lens of the flow module to the right of the centre of mass.
    flow_y = 0.0, "m", -0.3 ..= 0.3;
    /// Lens of the flow module below the centre of mass.
    flow_z = 0.0, "m", -0.3 ..= 0.3;
    /// MAVLink system whose poses, flow and range are taken beside the vehicle's own; 0 for none.
    mav_inputs_sys = 0.0, "1", 0.0 ..= 255.0;
    /// Samples per second of the vehicle's inertial sensor; a part that cannot takes its nearest.
    imu_rate: ImuRate = ImuRate::Hz4000, "Hz";
    /// Full scale of the gyroscope.
    imu_gyro_range: ImuGyroRange = ImuGyroRange::Dps2000, "deg/s";
    /// Full scale of the accelerometer.
    imu_accel_range: ImuAccelRange = ImuAccelRange::G16, "g";
    /// Clock of the arm sensors' buses. Read by the board at start-up.
    arm_bus_khz: ArmBusSpeed = ArmBusSpeed::Fast, "kHz";
    /// Frames per second of the tendon servos; analog servos want 50.
    servo_frame_rate = 50.0, "Hz", 50.0 ..= 333.0;

    /// Infill of the arms; Eq. 1 covers 4 to 10 %, below 6 % the paper's authors did not fly.
    infill = 6.9, "%", 4.0 ..= 10.0;
    /// Gain on the elastic term of Eq. 1 that the paper's Table III needs; 1 is the literal equation.
    gain_k = 7.75, "1", 1.0 ..= 10.0;
    /// Linear coefficient A1 of Eq. 1 (paper, Table I; of your own arm from `sophie fit-arm`).
    arm_a1 = 2.4387, "deg/N", -10.0 ..= 30.0;
    /// What A1 loses for each percent of infill, A2 (paper, Table I).
    arm_a2 = -0.1997, "deg/(N %)", -10.0 ..= 30.0;
    /// Quadratic coefficient B1 of Eq. 1 (paper, Table I).
    arm_b1 = -0.162, "deg/N2", -10.0 ..= 30.0;
    /// What B1 gains for each percent of infill, B2 (paper, Table I).
    arm_b2 = 0.0151, "deg/(N2 %)", -10.0 ..= 30.0;
    /// Thrust at which an arm is level, as a share of the largest: sets α0 (paper, "positive above 50 %").
    arm_level_share = 0.5, "1", -0.5 ..= 1.0;
    /// Exponent C_P of the battery's power ratio in Eq. 1 (paper, 1.6 to 1.8).
    power_exponent = 1.7, "1", 1.0 ..= 2.5;
    /// Cut-off of the thrust about which the arm model is linearised (0.2 to 30 Hz all work).
    tilt_cutoff = 5.0, "Hz", 0.2 ..= 30.0;
    /// Gain of the arms' IMUs on the tilt bias, each 10 ms.
    tilt_bias_gain = 0.02, "1", 0.0 ..= 0.05;
    /// Largest tilt bias accepted.
    tilt_bias_max = 0.2, "rad", 0.0 ..= 0.5;

    /// Tilt that the sensor of arm 1 shows while the arm is straight, taken off (`calibrate arm`).
    arm_zero_1 = 0.0, "rad", -0.6 ..= 0.6;
    /// Tilt that the sensor of arm 2 shows while the arm is straight.
    arm_zero_2 = 0.0, "rad", -0.6 ..= 0.6;
    /// Tilt that the sensor of arm 3 shows while the arm is straight.
    arm_zero_3 = 0.0, "rad", -0.6 ..= 0.6;
    /// Tilt that the sensor of arm 4 shows while the arm is straight.
    arm_zero_4 = 0.0, "rad", -0.6 ..= 0.6;
    /// Sign of the sensor of arm 1: -1 for one that is mounted the other way round (`calibrate arm`).
    arm_sign_1: ArmSign = ArmSign::Along, "1";
    /// Sign of the sensor of arm 2.
    arm_sign_2: ArmSign = ArmSign::Along, "1";
    /// Sign of the sensor of arm 3.
    arm_sign_3: ArmSign = ArmSign::Along, "1";
    /// Sign of the sensor of arm 4.
    arm_sign_4: ArmSign = ArmSign::Along, "1";

    /// How the inertial sensor sits beyond what the board's file says: where its axes have the vehicle's nose and belly
    /// (`calibrate mounting`).
    imu_mounting: ImuMounting = ImuMounting::FORWARD_DOWN, "1";
    /// Accelerometer bias along x of the board's axes, before the mounting: what it reads beyond gravity.
    accel_bias_x = 0.0, "m/s2", -0.6 ..= 0.6;
    /// Accelerometer bias along y.
    accel_bias_y = 0.0, "m/s2", -0.6 ..= 0.6;
    /// Accelerometer bias along z.
    accel_bias_z = 0.0, "m/s2", -0.6 ..= 0.6;
    /// What the accelerometer reads along x of the board's axes over what there is (`calibrate accel`).
    accel_scale_x = 1.0, "1", 0.9 ..= 1.1;
    /// What it reads along y over what there is.
    accel_scale_y = 1.0, "1", 0.9 ..= 1.1;
    /// What it reads along z over what there is.
    accel_scale_z = 1.0, "1", 0.9 ..= 1.1;
    /// Accelerometer gain of the attitude estimator.
    estimator_kp = 0.1, "1/s", 0.01 ..= 5.0;
    /// Gyro bias gain of the attitude estimator.
    estimator_ki = 0.002, "1/s2", 0.0 ..= 1.0;
    /// Cut-off of the gyro's low-pass filter.
    gyro_cutoff = 90.0, "Hz", 20.0 ..= 400.0;

    /// Angle to rate, roll and pitch.
    attitude_p = 4.5, "1/s", 0.5 ..= 12.0;
    /// Angle to rate, yaw.
    attitude_yaw_p = 1.2, "1/s", 0.0 ..= 5.0;
    /// Cut-off of the attitude setpoint's prefilter (10 rad/s).
    setpoint_lpf_hz = 1.5915494, "Hz", 0.15 ..= 16.0;
    /// Largest body rate that the attitude loop asks for.
    rate_max = 3.5, "rad/s", 0.5 ..= 12.0;
    /// Rate to angular acceleration, roll.
    rate_roll_p = 20.0, "1/s", 0.0 ..= 60.0;
    /// Integral gain, roll: takes up what turns the vehicle off a pipe's crown as the rotors near it.
    rate_roll_i = 50.0, "1/s2", 0.0 ..= 200.0;
    /// Rate to angular acceleration, pitch: bending arms leave less room than for roll.
    rate_pitch_p = 10.0, "1/s", 0.0 ..= 40.0;
    /// Integral gain, pitch.
    rate_pitch_i = 8.0, "1/s2", 0.0 ..= 100.0;
    /// Derivative gain on the measured rate, roll and pitch.
    rate_d = 0.0, "1", 0.0 ..= 1.0;
    /// Cut-off of the derivative's low-pass filter.
    rate_d_cutoff = 40.0, "Hz", 5.0 ..= 200.0;
    /// Rate to angular acceleration, yaw.
    rate_yaw_p = 3.0, "1/s", 0.0 ..= 10.0;
    /// Integral gain, yaw.
    rate_yaw_i = 1.5, "1/s2", 0.0 ..= 20.0;
    /// Fastest turn of the heading setpoint: torsion is the soft frame's weak side.
    yaw_slew = 0.5, "rad/s", 0.05 ..= 6.0;
    /// Largest thrust that yaw may add to or take from one rotor.
    yaw_thrust_max = 1.5, "N", 0.1 ..= 5.0;
    /// Centre of the yaw notch: the arms' bending mode.
    notch_hz = 4.75, "Hz", 1.0 ..= 40.0;
    /// Damping ratio of the notch's zeros.
    notch_zeta_zero = 0.2, "1", 0.0 ..= 1.0;
    /// Damping ratio of the notch's poles.
    notch_zeta_pole = 0.8, "1", 0.1 ..= 2.0;
    /// Mean thrust of a rotor below which yaw is given up: the quasi-static reversal is near.
    yaw_gate_thrust = 1.95, "N", 0.0 ..= 5.0;

    /// Largest roll and pitch angle of a full stick.
    stick_angle = 0.61, "rad", 0.1 ..= 1.0;
    /// Body rate of a full stick in rate mode.
    stick_rate = 3.0, "rad/s", 0.5 ..= 10.0;
    /// Yaw rate of a full stick.
    stick_yaw_rate = 0.5, "rad/s", 0.1 ..= 6.0;
    /// Roll and pitch torque of a full stick in direct mode.
    stick_torque = 1.0, "N m", 0.05 ..= 4.0;
    /// Yaw torque of a full stick in direct mode.
    stick_yaw_torque = 0.1, "N m", 0.01 ..= 1.0;
    /// Share of the throttle's travel about the pilot's zero that counts as low.
    throttle_low = 0.05, "1", 0.01 ..= 0.2;
    /// Throttle below which the landing on the pipe may start; the paper closes at about 30 %.
    perch_thr_max = 0.42, "1", 0.1 ..= 0.6;
    /// Share of the weight that the rotors go on carrying from the first sure touch until the grip is proven, at most: less
    /// presses the belly on, more steers (measured on the simulated pipe).
    perch_lift = 0.375, "1", 0.1 ..= 0.6;
    /// Sliding friction of the belly pads on the pipe: 0.3 of wet or oily steel, 0.6 of rubber on dry paint (assumed; `sophie
    /// bringup` measures it). It sets the leans up to which the arms close and let go; a lean that grows ends a closing at any
    /// friction.
    pipe_friction = 0.6, "1", 0.1 ..= 1.5;
    /// Diameter of the pipe (paper). A grip is proven on pipes of 0.6 to 1.5 times this; on its own the vehicle looks for one of
    /// 0.3 to 1.6 times; the leans above change by 1.5 degrees from 0.2 to 0.4 m.
    pipe_diameter = 0.3, "m", 0.1 ..= 2.0;

    /// Contact pressure of a proven grip (paper).
    grip_pressure = 950.0, "Pa", 100.0 ..= 5000.0;
    /// Error of the mean contact pressure at which a grip is proven: 15 % of it, as a force sensor's own error and what
    /// friction of the tendon leaves.
    grip_tolerance = 142.0, "Pa", 10.0 ..= 500.0;
    /// Time for which the mean pressures must stay within the tolerance, and hardly change.
    grip_dwell = 0.5, "s", 0.05 ..= 5.0;
    /// Pressure below which an arm counts as free of the pipe.
    release_pressure = 80.0, "Pa", 10.0 ..= 500.0;
    /// Longest time that the closing may take before it is given up.
    clamp_timeout = 10.0, "s", 1.0 ..= 60.0;
    /// Largest servo torque, 25 kgcm (paper).
    servo_torque_max = 2.452, "N m", 0.1 ..= 4.0;
    /// Stall torque of the servo in use, 35 kgcm as the paper says; 0.92 for an MG996R at 4.8 V (datasheet).
    servo_stall = 3.432, "N m", 0.1 ..= 5.0;
    /// Travel of every servo from its release to its full pulse (assumed, the 270 degree version of 35 kgcm servos).
    /// Common: what differs from servo to servo is the pulses at which it stands at the two ends of this travel.
    servo_range = 4.71, "rad", 0.5 ..= 6.3;
    /// Radius of the reel on the servo (assumed).
    reel_radius = 0.015, "m", 0.002 ..= 0.05;
    /// Distance of the tendon from the arm's neutral line: along the underside (derived, half the root's height).
    tendon_lever = 0.015, "m", 0.005 ..= 0.1;
    /// Tilt of a free arm by its tendon over that by a thrust of the same moment at the root: 2 for a beam alike along its
    /// length, 1 for a hinge (derived; of your own arm from `sophie fit-arm`). Times tendon_lever / arm_d and the tilt per
    /// thrust it is the tilt per tendon force.
    tendon_bend = 2.0, "1", 0.5 ..= 6.0;
    /// Tendon force that balances a thrust at equal pressure on the pipe, over that of the same moment at the root: 0.55 for a
    /// beam on a pipe of 0.3 m, 1 for a hinge (derived; of your own arm from `sophie fit-arm`). Times arm_d / tendon_lever it
    /// is tendon force per thrust.
    tendon_relief = 0.55, "1", 0.1 ..= 2.0;
    /// Stiffness along the tendon: nylon of 1 mm and 0.25 m, E 2.5 GPa (derived, 30 %).
    tendon_stiffness = 8000.0, "N/m", 200.0 ..= 100000.0;
    /// Pressure loop: proportional gain, tendon force per pressure.
    clamp_p = 0.0035, "N/Pa", 0.0 ..= 0.2;
    /// Pressure loop: integral gain.
    clamp_i = 0.05, "N/(Pa s)", 0.0 ..= 1.0;
    /// Pressure loop: derivative gain on the measured pressure.
    clamp_d = 0.00003, "N s/Pa", 0.0 ..= 0.05;
    /// Speed at which an arm is bent down until it touches; the force's rise follows from infill,
    /// gain_k and tendon_bend, then from the bending measured in the closing.
    clamp_approach = 0.7, "rad/s", 0.05 ..= 3.0;
    /// Fastest fall of the tendon force on release: an escape waits for it.
    clamp_release = 500.0, "N/s", 5.0 ..= 500.0;
    /// Trim of servo 1 against its reel's release mark; moves both ends of its travel.
    servo_trim_1 = 0.0, "us", -50.0 ..= 50.0;
    /// Trim of servo 2.
    servo_trim_2 = 0.0, "us", -50.0 ..= 50.0;
    /// Trim of servo 3.
    servo_trim_3 = 0.0, "us", -50.0 ..= 50.0;
    /// Trim of servo 4.
    servo_trim_4 = 0.0, "us", -50.0 ..= 50.0;
    /// Pulse at which servo 1 stands at its release position; 50 us within the usual 500 to 2500, for the trim.
    servo_release_1 = 550.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 2 at its release position.
    servo_release_2 = 550.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 3 at its release position.
    servo_release_3 = 550.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 4 at its release position.
    servo_release_4 = 550.0, "us", 550.0 ..= 2450.0;
    /// Pulse at which servo 1 has travelled `servo_range`; below the release pulse for a mirrored servo.
    servo_full_1 = 2450.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 2 at `servo_range`.
    servo_full_2 = 2450.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 3 at `servo_range`.
    servo_full_3 = 2450.0, "us", 550.0 ..= 2450.0;
    /// Pulse of servo 4 at `servo_range`.
    servo_full_4 = 2450.0, "us", 550.0 ..= 2450.0;
    // The pulses of the others are a guess that may lie beyond an end stop.
    /// Servos whose release and full pulses are measured (`calibrate servo`): 1234 for all. Others get no pulse.
    servo_marks: ServoMarks = ServoMarks::None, "1";
    /// Slew of servo 1 (MG996R datasheet, 0.17 s for 60 degrees at 4.8 V).
    servo_slew_1 = 6.16, "rad/s", 0.5 ..= 20.0;
    /// Slew of servo 2.
    servo_slew_2 = 6.16, "rad/s", 0.5 ..= 20.0;
    /// Slew of servo 3.
    servo_slew_3 = 6.16, "rad/s", 0.5 ..= 20.0;
    /// Slew of servo 4.
    servo_slew_4 = 6.16, "rad/s", 0.5 ..= 20.0;
    /// Active area of the FSR (Interlink 406 datasheet, 38 mm square).
    fsr_area = 0.001444, "m2", 0.00005 ..= 0.01;
    /// Conductance of the FSR per force (Interlink 406 guide: about 10 kOhm at 1 N, assumed linear).
    fsr_gain = 0.0001, "S/N", 0.00001 ..= 0.01;
    /// Resistor of the FSR's divider, to ground.
    fsr_divider = 10000.0, "Ohm", 1000.0 ..= 100000.0;
    /// Voltage between the FSR of arm 1 and `fsr_divider` at which the converter is at full scale, over the FSR's supply:
    /// 1 on a bare pad and 3.3 V, 2 on a pad with a divider 1:2.
    fsr_scale_1 = 1.0, "1", 0.05 ..= 20.0;
    /// Full scale of the FSR of arm 2.
    fsr_scale_2 = 1.0, "1", 0.05 ..= 20.0;
    /// Full scale of the FSR of arm 3.
    fsr_scale_3 = 1.0, "1", 0.05 ..= 20.0;
    /// Full scale of the FSR of arm 4.
    fsr_scale_4 = 1.0, "1", 0.05 ..= 20.0;
    /// Conductance of the FSR of arm 1 over `fsr_gain` (`calibrate fsr`).
    fsr_trim_1 = 1.0, "1", 0.2 ..= 5.0;
    /// Conductance of the FSR of arm 2 over `fsr_gain`.
    fsr_trim_2 = 1.0, "1", 0.2 ..= 5.0;
    /// Conductance of the FSR of arm 3 over `fsr_gain`.
    fsr_trim_3 = 1.0, "1", 0.2 ..= 5.0;
    /// Conductance of the FSR of arm 4 over `fsr_gain`.
    fsr_trim_4 = 1.0, "1", 0.2 ..= 5.0;
    /// Pressure that the FSR of arm 1 shows while nothing presses it, taken off (`calibrate fsr`); negative: the pressure
    /// from which it begins to show any, added beyond.
    fsr_zero_1 = 0.0, "Pa", -650.0 ..= 300.0;
    /// Pressure that the FSR of arm 2 shows while nothing presses it, taken off.
    fsr_zero_2 = 0.0, "Pa", -650.0 ..= 300.0;
    /// Pressure that the FSR of arm 3 shows while nothing presses it, taken off.
    fsr_zero_3 = 0.0, "Pa", -650.0 ..= 300.0;
    /// Pressure that the FSR of arm 4 shows while nothing presses it, taken off.
    fsr_zero_4 = 0.0, "Pa", -650.0 ..= 300.0;

    /// Battery voltage over the voltage at its pin; the default is the board's own (docs/wiring.md).
    battery_divider = 11.0, "1", 1.0 ..= 60.0;
    /// Battery current for each volt at the current sensor's pin; the default is the board's own (docs/wiring.md).
    battery_a_per_v = 40.0, "A/V", 1.0 ..= 1000.0;
    /// Battery voltage of full thrust: the curve is normalised to it (4S nominal).
    battery_nominal = 14.8, "V", 6.0 ..= 52.0;
    /// Usable charge of a fresh flight battery (paper, 1800 mAh).
    battery_capacity = 6480.0, "A s", 360.0 ..= 200000.0;
    /// Battery voltage under load at which arming is refused and the pilot is warned.
    battery_warning = 13.6, "V", 5.0 ..= 52.0;
    /// Battery voltage under load at which the failsafe lands.
    battery_critical = 12.6, "V", 5.0 ..= 52.0;
    /// Servo battery's voltage over that at its pin; 0 where it is not measured.
    servo_batt_div = 0.0, "1", 0.0 ..= 60.0;
    // 3.6 V a cell of 2S under load, where a tenth to a fifth of the charge is left, and 3.4 V, a twentieth.
    /// Servo battery's voltage at which the pilot is warned.
    servo_batt_warn = 7.2, "V", 0.0 ..= 52.0;
    /// Servo battery's voltage at which arming and perching are refused.
    servo_batt_low = 6.8, "V", 0.0 ..= 52.0;
}
