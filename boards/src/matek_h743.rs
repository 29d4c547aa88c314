//! Matek H743 (WING, SLIM, MINI; V3 with the ICM-42688-P): STM32H743VI at 400 MHz. The reference board.
//!
//! | what | peripheral | DMA stream | pads |
//! |---|---|---|---|
//! | inertial sensor | SPI1, EXTI2 | DMA2 2 and 3 | on board |
//! | motors 1 to 4 | TIM4 | DMA1 0 | S7, S8, S9, S10 |
//! | servos 1 to 4 | TIM5 | none | S3, S4, S5, S6 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 1 to 4 | CL1 DA1, CL2 DA2 |
//! | barometer, DPS310 | I2C2, with arm sensors 3 and 4 | DMA1 3 and 4 | on board |
//! | pressure 1 to 4, battery, servo battery | ADC1 | DMA2 4 | S1, S2, RSSI, CU2; on board; VB2 |
//! | receiver | USART6 | DMA2 0 and 1 | RX6, TX6 |
//! | console | UART7 | none | RX7, TX7 |
//! | MAVLink | USART1 | none | RX1, TX1 |
//! | flow and range | USART3 | none | RX3 |
//! | USB | OTG_FS | none | on board |
//! | parameters | flash | none | sectors 6 and 7 of bank 2 |
//! | time | TIM2 | none | |
//!
//! Motors and servos each have a timer of their own: a motor frame stops its timer between frames, and a servo
//! wants 50 Hz. Pins are those of the board's maker as Betaflight (`MATEKH743`) and ArduPilot (`MatekH743`) name them.

use assign_resources::assign_resources;
use embassy_embedded_hal::shared_bus::asynch::i2c::I2cDevice;
use embassy_stm32::adc::AdcChannel;
use embassy_stm32::exti::{self, ExtiInput};
use embassy_stm32::gpio::{Level, Pin, Pull};
use embassy_stm32::spi::Spi;
use embassy_stm32::time::mhz;
use embassy_stm32::{Peri, bind_interrupts, dma, i2c, interrupt, pac, peripherals, rcc, usart, usb};
use embassy_sync::mutex::Mutex;
use sophie_control::params::Params;
use sophie_drivers::arm_buses::ArmBuses;
use sophie_drivers::bno055;
use sophie_drivers::dps310::Dps310;
use sophie_drivers::esc_protocol::EscProtocol;
use sophie_drivers::icm42688p::{self, Icm42688p};
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_tasks::links::last_value::Raw;
use static_cell::StaticCell;

use crate::Board;
use crate::cortex_m::{enable_caches, levels_on};
use crate::stm32::{
    AnalogInputs, ArmBus, BoardStorage, BusErrors, DmaChip, Dog, EscTimer, Lamp, Lights, ParamFlash,
    PortLevels, ReadyLine, ReadyStamp, Selected, ServoTimer, ThisChip, UsbPort, WatchErrors, Wiring,
    console_lines, drive, ground_line, i2c_bus, load_parameters, look, mavlink_lines, pad, receiver_line,
    spi_config,
};

/// Name in the log.
pub const NAME: &str = "matek-h743";
/// What it calls itself on USB.
const PRODUCT: &str = "SOPHIE matek-h743";

/// Flash sectors that hold parameters, a bit each: sectors 6 and 7 of bank 2.
const PARAM_SECTORS: u32 = 1 << 14 | 1 << 15;
/// The data cache is off until a board has passed its rig with it: what DMA writes is never cached by the memory
/// protection's word alone, which no emulator checks.
pub const DATA_CACHE: bool = cfg!(feature = "data-cache");
/// The parameters' defaults of this board: its divider of 1:11 and its sensor of 40 A/V, as the maker states.
static DEFAULTS: Params = Params {
    battery_divider: 11.0,
    battery_a_per_v: 40.0,
    ..Params::DEFAULT
};

/// What `cargo xtask rig` joins (hil/README.md).
pub const WIRING: Wiring = Wiring {
    core_hz: 400_000_000,
    motor: [pad("S7 (PD12)", pac::GPIOD, 12), pad("S5 (PA2)", pac::GPIOA, 2)],
    servo: [pad("S3 (PA0)", pac::GPIOA, 0), pad("S6 (PA3)", pac::GPIOA, 3)],
    receiver: [pad("TX6 (PC6)", pac::GPIOC, 6), pad("RX6 (PC7)", pac::GPIOC, 7)],
    divider: (pad("RSSI (PC5)", pac::GPIOC, 5), 2),
};

/// The vehicle's inertial sensor.
pub type ImuPort = Icm42688p<DmaChip, ReadyLine>;
/// The arms' inertial sensors.
pub type ArmsPort = ArmBuses<ArmBus<LeftArms>, RightBus>;
/// The barometer.
pub type BarometerPort = Dps310<RightBus>;
/// The bus of arm sensors 3 and 4 and of the barometer: who waits for it waits for one transaction, half a millisecond.
type RightBus = I2cDevice<'static, Raw, ArmBus<RightArms>>;
/// Pressure sensors and battery.
pub type AnalogPort = AnalogInputs<peripherals::DMA2_CH4, Irqs>;
/// The motors.
pub type MotorsPort = EscTimer<peripherals::TIM4, peripherals::DMA1_CH0, Irqs>;
/// The tendon servos.
pub type ServosPort = ServoTimer<peripherals::TIM5>;
/// The watchdog.
pub type WatchdogPort = Dog<peripherals::IWDG1>;
/// Where parameters are stored.
pub type StoragePort = BoardStorage<ParamFlash<0x2_0000>>;
/// Lights and buzzer.
pub type LightsPort = Lights<Lamp>;

static RIGHT_BUS: StaticCell<Mutex<Raw, ArmBus<RightArms>>> = StaticCell::new();

levels_on!(SAI3, SAI4);
i2c_bus!(LeftArms, Irqs, I2C1);
i2c_bus!(RightArms, Irqs, I2C2);

bind_interrupts! {
    /// Which handler serves which vector.
    pub struct Irqs {
        DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
        DMA1_STREAM1 => dma::InterruptHandler<peripherals::DMA1_CH1>;
        DMA1_STREAM2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
        DMA1_STREAM3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
        DMA1_STREAM4 => dma::InterruptHandler<peripherals::DMA1_CH4>;
        DMA2_STREAM0 => dma::InterruptHandler<peripherals::DMA2_CH0>;
        DMA2_STREAM1 => dma::InterruptHandler<peripherals::DMA2_CH1>;
        DMA2_STREAM2 => dma::InterruptHandler<peripherals::DMA2_CH2>;
        DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
        DMA2_STREAM4 => dma::InterruptHandler<peripherals::DMA2_CH4>;
        EXTI2 => ReadyStamp, exti::InterruptHandler<interrupt::typelevel::EXTI2>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>, WatchErrors<peripherals::I2C1>;
        I2C1_ER => BusErrors<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>, WatchErrors<peripherals::I2C2>;
        I2C2_ER => BusErrors<peripherals::I2C2>;
        OTG_FS => usb::InterruptHandler<peripherals::USB_OTG_FS>;
        UART7 => usart::BufferedInterruptHandler<peripherals::UART7>;
        USART1 => usart::BufferedInterruptHandler<peripherals::USART1>;
        USART3 => usart::BufferedInterruptHandler<peripherals::USART3>;
        USART6 => usart::InterruptHandler<peripherals::USART6>;
    }
}

assign_resources! {
    imu: ImuParts {
        spi: SPI1,
        clock: PA5,
        data_in: PA6,
        data_out: PD7,
        select: PC15,
        tx_dma: DMA2_CH3,
        rx_dma: DMA2_CH2,
        ready: PB2,
        ready_line: EXTI2,
    }
    motors: MotorParts {
        timer: TIM4,
        motor_1: PD12,
        motor_2: PD13,
        motor_3: PD14,
        motor_4: PD15,
        dma: DMA1_CH0,
    }
    servos: ServoParts {
        timer: TIM5,
        servo_1: PA0,
        servo_2: PA1,
        servo_3: PA2,
        servo_4: PA3,
    }
    left_arms: LeftArms {
        bus: I2C1,
        clock: PB6,
        data: PB7,
        tx_dma: DMA1_CH1,
        rx_dma: DMA1_CH2,
    }
    right_arms: RightArms {
        bus: I2C2,
        clock: PB10,
        data: PB11,
        tx_dma: DMA1_CH3,
        rx_dma: DMA1_CH4,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PB0,
        fsr_2: PB1,
        fsr_3: PC5,
        fsr_4: PA7,
        battery_voltage: PC0,
        battery_current: PC1,
        servo_battery: PA4,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART6,
        rx: PC7,
        tx: PC6,
        rx_dma: DMA2_CH0,
        tx_dma: DMA2_CH1,
    }
    console: ConsoleParts {
        uart: UART7,
        rx: PE7,
        tx: PE8,
    }
    mavlink: MavlinkParts {
        uart: USART1,
        rx: PA10,
        tx: PA9,
    }
    ground: GroundParts {
        uart: USART3,
        rx: PD9,
        tx: PD8,
    }
    usb: UsbParts {
        core: USB_OTG_FS,
        dp: PA12,
        dm: PA11,
    }
    storage: StorageParts {
        flash: FLASH,
    }
    lights: LightParts {
        blue: PE3,
        green: PE4,
        buzzer: PA15,
    }
    watchdog: WatchdogParts {
        dog: IWDG1,
    }
}

/// Starts the clocks, loads the parameters and builds every port as they say. Called once.
pub async fn take() -> Board {
    let p = crate::stm32::start(clocks(), pac::TIM2);
    enable_caches(DATA_CACHE);
    let parts = split_resources!(p);
    let mut storage = storage(parts.storage);
    let (params, loaded) = load_parameters(&mut storage);
    let chip = ThisChip::new(look(loaded, PARAM_SECTORS));
    let r = parts.receiver;
    let (receiver, telemetry) = receiver_line(r.uart, r.rx, r.tx, r.rx_dma, r.tx_dma, Irqs, &params);
    let c = parts.console;
    let (console_input, console_output) = console_lines(c.uart, c.rx, c.tx, Irqs);
    let m = parts.mavlink;
    let (mavlink_input, mavlink_output) = mavlink_lines(m.uart, m.rx, m.tx, Irqs);
    let g = parts.ground;
    let ground = ground_line(g.uart, g.rx, g.tx, Irqs, &params);
    let right: &'static _ = RIGHT_BUS.init(Mutex::new(ArmBus::new(parts.right_arms, params.arm_bus_khz)));
    Board {
        watchdog: Dog::start(parts.watchdog.dog),
        motors: motors(parts.motors, &params),
        imu: imu(parts.imu, &params),
        arms: ArmBuses::new(
            ArmBus::new(parts.left_arms, params.arm_bus_khz),
            I2cDevice::new(right),
            [bno055::Config::default(); 4],
        ),
        barometer: Dps310::at(I2cDevice::new(right)),
        analog: analog(parts.analog),
        servos: servos(parts.servos, &params),
        receiver,
        telemetry,
        console_input,
        console_output,
        mavlink_input,
        mavlink_output,
        ground,
        usb: UsbPort::new(parts.usb.core, parts.usb.dp, parts.usb.dm, Irqs, PRODUCT),
        lights: lights(parts.lights),
        storage,
        params,
        loaded,
        chip,
    }
}

/// 8 MHz crystal; core 400 MHz, buses 100 MHz, timers 200 MHz, SPI1 and USB 48 MHz, converter 50 MHz (halved inside).
///
/// 480 MHz would need the regulator's boost, which only half of the chip revisions have.
fn clocks() -> embassy_stm32::Config {
    use rcc::*;

    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: mhz(8),
        mode: HseMode::Oscillator,
    });
    rcc.csi = true;
    let pll = Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV1,
        fracn: None,
        // 800 MHz: above a reference of 2 MHz the range of 150 to 420 MHz is not allowed (RM0433 §8.7.12).
        mul: PllMul::MUL100,
        divp: Some(PllDiv::DIV16),
        divq: None,
        divr: None,
    };
    rcc.pll1 = Some(Pll {
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV8),
        ..pll
    });
    rcc.pll2 = Some(pll);
    // 48 MHz for USB and for the inertial sensor's bus, of which half is what the part takes; 800 MHz have no such divider.
    rcc.pll3 = Some(Pll {
        mul: PllMul::MUL96,
        divq: Some(PllDiv::DIV16),
        ..pll
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    rcc.ls = LsConfig::off();
    rcc.mux.adcsel = mux::Adcsel::PLL2_P;
    rcc.mux.spi123sel = mux::Saisel::PLL3_P;
    rcc.mux.usbsel = mux::Usbsel::PLL3_Q;
    config
}

fn imu(p: ImuParts, params: &Params) -> ImuPort {
    let config = spi_config(&p.spi, icm42688p::SPI_HZ);
    let bus = Spi::new(
        p.spi, p.clock, p.data_out, p.data_in, p.tx_dma, p.rx_dma, Irqs, config,
    );
    let number = p.ready.pin();
    let ready = ReadyLine::new(ExtiInput::new(p.ready, p.ready_line, Pull::Down, Irqs), number);
    // On the underside, turned by half a turn about the vertical (ArduPilot: ROTATION_YAW_180).
    let mounting = Mounting::top_down(Heading::Back);
    Icm42688p::new(
        Selected::new(bus, p.select),
        ready,
        icm42688p::Config::from_params(params),
        mounting,
    )
}

fn motors(p: MotorParts, params: &Params) -> MotorsPort {
    let pins = (p.motor_1, p.motor_2, p.motor_3, p.motor_4);
    EscTimer::new(p.timer, pins, p.dma, Irqs, EscProtocol::from_params(params))
}

const MOTORS_LOW: [PortLevels; 1] = [PortLevels::new(pac::GPIOD, &[12, 13, 14, 15], &[])];

/// The motors' pins low, whatever drives them: the last resort of a fault handler.
pub fn stop_motors() {
    drive(&MOTORS_LOW);
}

/// What the outputs are until their ports take them: motors, servos and buzzer low, the inertial sensor not selected.
pub const FIRST_LEVELS: [PortLevels; 3] = [
    MOTORS_LOW[0],
    PortLevels::new(pac::GPIOA, &[0, 1, 2, 3, 15], &[]),
    PortLevels::new(pac::GPIOC, &[], &[15]),
];

fn servos(p: ServoParts, params: &Params) -> ServosPort {
    ServoTimer::new(p.timer, (p.servo_1, p.servo_2, p.servo_3, p.servo_4), params)
}

fn analog(p: AnalogParts) -> AnalogPort {
    let channels = [
        p.fsr_1.degrade_adc(),
        p.fsr_2.degrade_adc(),
        p.fsr_3.degrade_adc(),
        p.fsr_4.degrade_adc(),
        p.battery_voltage.degrade_adc(),
        p.battery_current.degrade_adc(),
        p.servo_battery.degrade_adc(),
    ];
    AnalogInputs::new(p.adc, channels, p.dma, Irqs)
}

fn storage(p: StorageParts) -> StoragePort {
    BoardStorage::new(ParamFlash::new(p.flash), &DEFAULTS)
}

fn lights(p: LightParts) -> LightsPort {
    Lights {
        state: Lamp::new(p.green, Level::Low),
        fault: Lamp::new(p.blue, Level::Low),
        buzzer: Lamp::new(p.buzzer, Level::High),
    }
}
