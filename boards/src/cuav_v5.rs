//! CUAV V5 (FMUv5): STM32F765II at 216 MHz, the paper's autopilot.
//!
//! | what | peripheral | DMA stream | connectors |
//! |---|---|---|---|
//! | inertial sensor, ICM-20689 | SPI1, EXTI4 | DMA2 2 and 3 | on board |
//! | motors 1 to 4 | TIM1 | DMA2 5 | AUX 4, 3, 2, 1 |
//! | servos 1 and 2, 3 and 4 | TIM4, TIM12 | none | AUX 5 and 6, 7 and 8 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 0 and 6, 2 and 7 | GPS, I2C2 |
//! | barometer, MS5611 | SPI4 | none | on board |
//! | pressure 1 to 4, battery, servo battery | ADC1 | DMA2 4 | ADC (PC4), CAP1 (PA5), RSSI (PB0), POWER2 current (PA3); POWER1; POWER2 voltage (PA2) |
//! | receiver | USART3 | DMA1 1 and 3 | TELEM2 |
//! | console | UART7 | none | FMU debug |
//! | MAVLink | USART2 | none | TELEM1 |
//! | flow and range | UART4 | none | UART4 |
//! | USB | OTG_FS | none | on board |
//! | parameters, FRAM | SPI2 | none | on board |
//! | lights, sounder | TIM9 | none | on board |
//! | time | TIM5 | none | |
//!
//! Only the AUX outputs are this chip's: the MAIN outputs and the RC input hang on a second one, whose firmware is
//! not ours. Motor 1 is the timer's first channel, which the board leads to AUX 4. Pins are those that PX4 (`fmu-v5`)
//! and ArduPilot (`fmuv5`) name.

use assign_resources::assign_resources;
use embassy_stm32::gpio::Level;
use embassy_stm32::time::mhz;
use embassy_stm32::{Peri, bind_interrupts, dma, exti, i2c, interrupt, pac, peripherals, rcc, usart, usb};
use embassy_time::{Duration, Timer};
use sophie_control::params::Params;
use sophie_drivers::fram::Fram;
use sophie_drivers::icm20689;
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_drivers::ms5611::{self, Ms5611};

use crate::cortex_m::levels_on;
use crate::stm32::{
    BusErrors, EscTimer, Lamp, Lights, PlainChip, PortLevels, ReadyStamp, ServoPairs, Tone, WatchErrors,
    Wiring, hold, i2c_bus, pad, plain_chip, ports,
};

/// Flash sectors that hold parameters: none, an FRAM does.
const PARAM_SECTORS: u32 = 0;
/// The data cache is on: all RAM that is used is DTCM, which no cache is before.
pub const DATA_CACHE: bool = true;
/// The parameters' defaults of this board: divider and current sensor of the power module that CUAV sells with it
/// (ArduPilot `fmuv5`: 18.0 and 24.0).
static DEFAULTS: Params = Params {
    battery_divider: 18.0,
    battery_a_per_v: 24.0,
    ..Params::DEFAULT
};

/// What `cargo xtask rig` joins (hil/README.md).
pub const WIRING: Wiring = Wiring {
    core_hz: 216_000_000,
    motor: [
        pad("AUX 4 (PE9)", pac::GPIOE, 9),
        pad("AUX 7 (PH6)", pac::GPIOH, 6),
    ],
    servo: [
        pad("AUX 5 (PD13)", pac::GPIOD, 13),
        pad("AUX 8 (PH9)", pac::GPIOH, 9),
    ],
    receiver: [
        pad("TELEM2 TX (PD8)", pac::GPIOD, 8),
        pad("TELEM2 RX (PD9)", pac::GPIOD, 9),
    ],
    divider: (pad("RSSI (PB0)", pac::GPIOB, 0), 2),
};

levels_on!(SAI1, SAI2);
i2c_bus!(LeftArms, Irqs, I2C1);
i2c_bus!(RightArms, Irqs, I2C2);

bind_interrupts! {
    /// Which handler serves which vector.
    pub struct Irqs {
        DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
        DMA1_STREAM1 => dma::InterruptHandler<peripherals::DMA1_CH1>;
        DMA1_STREAM2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
        DMA1_STREAM3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
        DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
        DMA1_STREAM7 => dma::InterruptHandler<peripherals::DMA1_CH7>;
        DMA2_STREAM2 => dma::InterruptHandler<peripherals::DMA2_CH2>;
        DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
        DMA2_STREAM4 => dma::InterruptHandler<peripherals::DMA2_CH4>;
        DMA2_STREAM5 => dma::InterruptHandler<peripherals::DMA2_CH5>;
        EXTI4 => ReadyStamp, exti::InterruptHandler<interrupt::typelevel::EXTI4>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>, WatchErrors<peripherals::I2C1>;
        I2C1_ER => BusErrors<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>, WatchErrors<peripherals::I2C2>;
        I2C2_ER => BusErrors<peripherals::I2C2>;
        OTG_FS => usb::InterruptHandler<peripherals::USB_OTG_FS>;
        UART4 => usart::BufferedInterruptHandler<peripherals::UART4>;
        UART7 => usart::BufferedInterruptHandler<peripherals::UART7>;
        USART2 => usart::BufferedInterruptHandler<peripherals::USART2>;
        USART3 => usart::InterruptHandler<peripherals::USART3>;
    }
}

assign_resources! {
    imu: ImuParts {
        spi: SPI1,
        clock: PG11,
        data_in: PA6,
        data_out: PD7,
        select: PF2,
        tx_dma: DMA2_CH3,
        rx_dma: DMA2_CH2,
        ready: PB4,
        ready_line: EXTI4,
    }
    rails: RailParts {
        sensors: PE3,
        peripherals_off: PG4,
        high_power_off: PF12,
        other_imu: PF3,
        other_gyro: PF4,
        other_accel: PG10,
        other_memory: PH5,
        other_on_barometer: PF11,
        radio_hold: PD4,
    }
    motors: MotorParts {
        timer: TIM1,
        motor_1: PE9,
        motor_2: PE11,
        motor_3: PA10,
        motor_4: PE14,
        dma: DMA2_CH5,
    }
    servos: ServoParts {
        first: TIM4,
        servo_1: PD13,
        servo_2: PD14,
        second: TIM12,
        servo_3: PH6,
        servo_4: PH9,
    }
    left_arms: LeftArms {
        bus: I2C1,
        clock: PB8,
        data: PB9,
        tx_dma: DMA1_CH6,
        rx_dma: DMA1_CH0,
    }
    right_arms: RightArms {
        bus: I2C2,
        clock: PF1,
        data: PF0,
        tx_dma: DMA1_CH7,
        rx_dma: DMA1_CH2,
    }
    barometer: BarometerParts {
        spi: SPI4,
        clock: PE2,
        data_in: PE13,
        data_out: PE6,
        select: PF10,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PC4,
        fsr_2: PA5,
        fsr_3: PB0,
        fsr_4: PA3,
        battery_voltage: PA0,
        battery_current: PA1,
        servo_battery: PA2,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART3,
        rx: PD9,
        tx: PD8,
        rx_dma: DMA1_CH1,
        tx_dma: DMA1_CH3,
    }
    console: ConsoleParts {
        uart: UART7,
        rx: PF6,
        tx: PE8,
    }
    mavlink: MavlinkParts {
        uart: USART2,
        rx: PD6,
        tx: PD5,
    }
    ground: GroundParts {
        uart: UART4,
        rx: PD0,
        tx: PD1,
    }
    usb: UsbParts {
        core: USB_OTG_FS,
        dp: PA12,
        dm: PA11,
    }
    storage: StorageParts {
        spi: SPI2,
        clock: PI1,
        data_in: PI2,
        data_out: PI3,
        select: PF5,
    }
    lights: LightParts {
        green: PC6,
        red: PB1,
        tone: TIM9,
        buzzer: PE5,
    }
    watchdog: WatchdogParts {
        dog: IWDG,
    }
}

ports! { |parts, params|
    name: "cuav-v5";
    time: TIM5;
    first: rails(parts.rails).await;
    storage: Fram<PlainChip> = {
        // Without DMA: its streams serve what flies. The part takes 40 MHz, the bus gives 13.5 MHz.
        let s = parts.storage;
        Fram::new(plain_chip(s.spi, s.clock, s.data_out, s.data_in, s.select, 20_000_000))
    };
    // At 6.75 MHz: the next divider below.
    imu: icm20689::Config;
    // Marking up, x to the right (ArduPilot: ROTATION_NONE after its driver's swap of x and y).
    mounting: Mounting::top_up(Heading::Right);
    barometer: Ms5611<PlainChip> = {
        // Without DMA: a transfer is of four bytes, 2 µs.
        let b = parts.barometer;
        Ms5611::on(plain_chip(b.spi, b.clock, b.data_out, b.data_in, b.select, ms5611::SPI_HZ))
    };
    motors: EscTimer<peripherals::TIM1, peripherals::DMA2_CH5, Irqs>;
    servos: ServoPairs<peripherals::TIM4, peripherals::TIM12> = {
        let s = parts.servos;
        ServoPairs::new(s.first, (s.servo_1, s.servo_2), s.second, (s.servo_3, s.servo_4), params)
    };
    analog: DMA2_CH4;
    lights: Lights<Tone<peripherals::TIM9>> = Lights {
        // As PX4 drives them: their other end may be at 5 V.
        state: Lamp::open_drain(parts.lights.green),
        fault: Lamp::open_drain(parts.lights.red),
        buzzer: Tone::new(parts.lights.tone, parts.lights.buzzer),
    };
}

/// 16 MHz crystal; core 216 MHz, buses 54 and 108 MHz, timers 108 and 216 MHz.
fn clocks() -> embassy_stm32::Config {
    use rcc::*;

    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: mhz(16),
        mode: HseMode::Oscillator,
    });
    rcc.pll_src = PllSource::HSE;
    rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV8,
        mul: PllMul::MUL216,
        divp: Some(PllPDiv::DIV2),
        // USB: 48 MHz.
        divq: Some(PllQDiv::DIV9),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV4;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.ls = LsConfig::off();
    rcc.mux.clk48sel = mux::Clk48sel::PLL1_Q;
    config
}

/// From the sensors' supply to a sensor that answers (ICM-20689 datasheet, start-up time for register access from
/// power-up: 100 ms at the most).
const SENSORS_START: Duration = Duration::from_millis(100);

/// Switches the supplies on, deselects other chips on the sensors' buses, and waits for the sensors. A radio at TELEM1
/// stays in its boot loader if this chip's RTS is low at the radio's power-up.
async fn rails(p: RailParts) {
    hold(p.other_imu.into(), Level::High);
    hold(p.other_gyro.into(), Level::High);
    hold(p.other_accel.into(), Level::High);
    hold(p.other_memory.into(), Level::High);
    hold(p.other_on_barometer.into(), Level::High);
    hold(p.radio_hold.into(), Level::High);
    hold(p.sensors.into(), Level::High);
    hold(p.peripherals_off.into(), Level::Low);
    hold(p.high_power_off.into(), Level::Low);
    Timer::after(SENSORS_START).await;
}

/// The motors' pins, low.
pub const MOTORS_LOW: [PortLevels; 2] = [
    PortLevels::new(pac::GPIOE, &[9, 11, 14], &[]),
    PortLevels::new(pac::GPIOA, &[10], &[]),
];

/// What the outputs are until their ports take them: motors, servos and sounder low, no chip selected, the radio not held
/// in its loader, every supply on, as they were before a restart.
pub const FIRST_LEVELS: [PortLevels; 7] = [
    MOTORS_LOW[0],
    MOTORS_LOW[1],
    PortLevels::new(pac::GPIOD, &[13, 14], &[4]),
    PortLevels::new(pac::GPIOH, &[6, 9], &[5]),
    PortLevels::new(pac::GPIOE, &[5], &[3]),
    PortLevels::new(pac::GPIOF, &[12], &[2, 3, 4, 5, 10, 11]),
    PortLevels::new(pac::GPIOG, &[4], &[10]),
];
