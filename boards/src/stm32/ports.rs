//! Common part of the board files: the types of the ports, and their order of construction.

/// Makes the board of a file: its `NAME`, the types of its ports, and `take`, which starts the chip and builds them.
///
/// Before it the file has `assign_resources!`, its groups and fields named as in the other boards' files, and somewhere
/// `Irqs`, `clocks`, `DEFAULTS` and `PARAM_SECTORS`. Whatever an entry builds is built of `parts`, the resources, as `params`
/// say, the parameters in force. The entries, in this order:
///
/// | entry | |
/// |---|---|
/// | `name` | in the log and on USB |
/// | `time` | timer that embassy-time counts with |
/// | `first`, optional | before any part is spoken to: supplies, selects of other chips |
/// | `storage` | memory of the parameters |
/// | `imu`, `mounting` | driver of the inertial sensor, and how the part sits on the board |
/// | `let`, optional | bus that several ports share |
/// | `arms`, optional | arm sensors, unless each pair has a bus of its own |
/// | `barometer`, optional | |
/// | `motors` | speed controllers; with how they are built, unless on one timer |
/// | `servos` | tendon servos |
/// | `analog` | DMA stream of the pressure sensors' and batteries' converter |
/// | `lights` | lights and buzzer |
macro_rules! ports {
    (
        |$parts:ident, $params:ident|
        name: $name:literal;
        time: $time:ident;
        $(first: $first:expr;)?
        storage: $memory:ty = $storage:expr;
        imu: $imu:ty;
        mounting: $mounting:expr;
        $(let $bus:ident = $shared:expr;)?
        $(arms: $arms:ty = $new_arms:expr;)?
        $(barometer: $barometer:ty = $new_barometer:expr;)?
        motors: $motors:ty $(= $new_motors:expr)?;
        servos: $servos:ty = $new_servos:expr;
        analog: $analog:ident;
        lights: $lights:ty = $new_lights:expr;
    ) => {
        /// Name in the log.
        pub const NAME: &str = $name;

        /// The vehicle's inertial sensor.
        pub type ImuPort = sophie_drivers::spi_imu::SpiImu<$imu, $crate::stm32::DmaChip, $crate::stm32::ReadyLine>;
        /// The arms' inertial sensors.
        pub type ArmsPort = $crate::stm32::ports!(@arms $($arms)?);
        /// The barometer, or none.
        pub type BarometerPort = $crate::stm32::ports!(@barometer $($barometer)?);
        /// Pressure sensors and battery.
        pub type AnalogPort = $crate::stm32::AnalogInputs<embassy_stm32::peripherals::$analog, Irqs>;
        /// The motors.
        pub type MotorsPort = $motors;
        /// The tendon servos.
        pub type ServosPort = $servos;
        /// Where parameters are stored.
        pub type StoragePort = $crate::stm32::BoardStorage<$memory>;
        /// Lights and buzzer.
        pub type LightsPort = $lights;

        static STORAGE: $crate::stm32::StorageCell<$memory> = $crate::stm32::StorageCell::new();

        /// Starts the clocks, loads the parameters and builds every port as they say. Called once.
        pub async fn take() -> $crate::Board {
            use embassy_stm32::adc::AdcChannel as _;
            use embassy_stm32::gpio::Pin as _;

            let p = $crate::stm32::start(clocks(), embassy_stm32::pac::$time);
            let $parts = split_resources!(p);
            $($first;)?
            let mut storage = $crate::stm32::BoardStorage::new(&STORAGE, $storage, &DEFAULTS);
            let (in_force, loaded) = $crate::stm32::load_parameters(&mut storage);
            let $params = &in_force;
            let chip = $crate::stm32::ThisChip::new($crate::stm32::look(loaded, PARAM_SECTORS));
            let r = $parts.receiver;
            let (receiver, telemetry) =
                $crate::stm32::receiver_line(r.uart, r.rx, r.tx, r.rx_dma, r.tx_dma, Irqs, $params);
            let c = $parts.console;
            let (console_input, console_output) = $crate::stm32::BufferedLine::console().open(c.uart, c.rx, c.tx, Irqs);
            let m = $parts.mavlink;
            let (mavlink_input, mavlink_output) = $crate::stm32::BufferedLine::mavlink().open(m.uart, m.rx, m.tx, Irqs);
            let g = $parts.ground;
            let ground = $crate::stm32::ground_line(g.uart, g.rx, g.tx, Irqs, $params);
            $(let $bus = $shared;)?
            $crate::Board {
                watchdog: $crate::stm32::WatchdogPort::start($parts.watchdog.dog),
                motors: $crate::stm32::ports!(@new_motors $parts $params $($new_motors)?),
                imu: {
                    let i = $parts.imu;
                    let config = $crate::stm32::spi_config(
                        &i.spi,
                        <$imu as sophie_drivers::spi_imu::Chip>::SPI_HZ,
                    );
                    let bus = embassy_stm32::spi::Spi::new(
                        i.spi, i.clock, i.data_out, i.data_in, i.tx_dma, i.rx_dma, Irqs, config,
                    );
                    let number = i.ready.pin();
                    let edge = embassy_stm32::exti::ExtiInput::new(
                        i.ready,
                        i.ready_line,
                        embassy_stm32::gpio::Pull::Down,
                        Irqs,
                    );
                    ImuPort::new(
                        $crate::stm32::Selected::new(bus, i.select),
                        $crate::stm32::ReadyLine::new(edge, number),
                        <$imu>::from_params($params),
                        $mounting,
                    )
                },
                arms: $crate::stm32::ports!(@new_arms $parts $params $($new_arms)?),
                barometer: $crate::stm32::ports!(@new_barometer $($new_barometer)?),
                analog: {
                    let a = $parts.analog;
                    let channels = [
                        a.fsr_1.degrade_adc(),
                        a.fsr_2.degrade_adc(),
                        a.fsr_3.degrade_adc(),
                        a.fsr_4.degrade_adc(),
                        a.battery_voltage.degrade_adc(),
                        a.battery_current.degrade_adc(),
                        a.servo_battery.degrade_adc(),
                    ];
                    AnalogPort::new(a.adc, channels, a.dma, Irqs)
                },
                servos: $new_servos,
                receiver,
                telemetry,
                console_input,
                console_output,
                mavlink_input,
                mavlink_output,
                ground,
                usb: $crate::stm32::UsbPort::new(
                    $parts.usb.core,
                    $parts.usb.dp,
                    $parts.usb.dm,
                    Irqs,
                    concat!("SOPHIE ", $name),
                ),
                lights: $new_lights,
                storage,
                params: in_force,
                loaded,
                chip,
            }
        }
    };

    (@arms) => {
        sophie_drivers::arm_buses::ArmBuses<
            $crate::stm32::ArmBus<LeftArms>,
            $crate::stm32::ArmBus<RightArms>,
        >
    };
    (@arms $arms:ty) => { $arms };
    (@new_arms $parts:ident $params:ident) => {
        ArmsPort::new(
            $crate::stm32::ArmBus::new($parts.left_arms, $params.arm_bus_khz),
            $crate::stm32::ArmBus::new($parts.right_arms, $params.arm_bus_khz),
            [sophie_drivers::bno055::Config::default(); 4],
        )
    };
    (@new_arms $parts:ident $params:ident $arms:expr) => { $arms };

    (@barometer) => { () };
    (@barometer $barometer:ty) => { $barometer };
    (@new_barometer) => { () };
    (@new_barometer $barometer:expr) => { $barometer };

    (@new_motors $parts:ident $params:ident) => {{
        let m = $parts.motors;
        let pins = (m.motor_1, m.motor_2, m.motor_3, m.motor_4);
        let protocol = sophie_drivers::esc_protocol::EscProtocol::from_params($params);
        MotorsPort::new(m.timer, pins, m.dma, Irqs, protocol)
    }};
    (@new_motors $parts:ident $params:ident $motors:expr) => { $motors };
}
pub(crate) use ports;
