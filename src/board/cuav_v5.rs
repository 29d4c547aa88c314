//! CUAV V5 (FMUv5): STM32F765II at 216 MHz, the paper's autopilot.
//!
//! | what | peripheral | DMA stream | connectors |
//! |---|---|---|---|
//! | inertial sensor, ICM-20689 | SPI1, EXTI4 | DMA2 2 and 3 | on board |
//! | motors 1 to 4 | TIM1 | DMA2 5 | AUX 4, 3, 2, 1 |
//! | servos 1 and 2, 3 and 4 | TIM4, TIM12 | none | AUX 5 and 6, 7 and 8 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 0 and 6, 2 and 7 | GPS, I2C2 |
//! | pressure 1 to 4, battery | ADC1 | DMA2 4 | ADC (PC4, PA4), RSSI (PB0), POWER2 current (PA3); POWER1 |
//! | receiver | USART3 | DMA1 1 and 3 | TELEM2 |
//! | lights | | none | on board |
//! | time | TIM5 | none | |
//!
//! Only the AUX outputs are this chip's: the MAIN outputs and the RC input hang on a second one, whose firmware is
//! not ours. Motor 1 is the timer's first channel, which the board leads to AUX 4. Pins are those that PX4 (`fmu-v5`)
//! and ArduPilot (`fmuv5`) name.

use assign_resources::assign_resources;
use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{AnyPin, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::i2c::I2c;
use embassy_stm32::mode::Async;
use embassy_stm32::spi::{MODE_3, Spi};
use embassy_stm32::time::{Hertz, hz, mhz};
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::usart::Uart;
use embassy_stm32::{Peri, bind_interrupts, dma, exti, i2c, interrupt, pac, peripherals, rcc, spi, usart};
use embassy_time::Duration;
use sophie_control::params::Params;
use sophie_drivers::arm_buses::ArmBuses;
use sophie_drivers::bno055;
use sophie_drivers::icm20689::{self, Icm20689};
use sophie_drivers::mounting::{Heading, Mounting};
use static_cell::ConstStaticCell;

use super::Board;
use super::stm32::{
    Aligned, AnalogInputs, AnalogScale, Converter, Dog, EscBurst, EscTimer, Lights, Protocol, ReceiverLine,
    Selected, ServoPairs, TelemetryLine,
};

/// Name in the log.
pub const NAME: &str = "cuav-v5";

/// The vehicle's inertial sensor.
pub type ImuPort = Icm20689<Selected, ExtiInput<'static, Async>>;
/// The arms' inertial sensors.
pub type ArmsPort = ArmBuses<I2c<'static, Async, i2c::Master>, I2c<'static, Async, i2c::Master>>;
/// Pressure sensors and battery.
pub type AnalogPort = AnalogInputs<Converter<peripherals::ADC1, peripherals::DMA2_CH4, Irqs>>;
/// The motors.
pub type MotorsPort = EscTimer<peripherals::TIM1, peripherals::DMA2_CH5, Irqs>;
/// The tendon servos.
pub type ServosPort = ServoPairs;
/// From the receiver.
pub type ReceiverPort = ReceiverLine;
/// To the receiver.
pub type TelemetryPort = TelemetryLine;
/// The watchdog.
pub type WatchdogPort = Dog<peripherals::IWDG>;

crate::levels_on!(SAI1, SAI2);

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
        EXTI4 => exti::InterruptHandler<interrupt::typelevel::EXTI4>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
        I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>;
        I2C2_ER => i2c::ErrorInterruptHandler<peripherals::I2C2>;
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
    arms: ArmParts {
        left: I2C1,
        left_clock: PB8,
        left_data: PB9,
        left_tx_dma: DMA1_CH6,
        left_rx_dma: DMA1_CH0,
        right: I2C2,
        right_clock: PF1,
        right_data: PF0,
        right_tx_dma: DMA1_CH7,
        right_rx_dma: DMA1_CH2,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PC4,
        fsr_2: PA4,
        fsr_3: PB0,
        fsr_4: PA3,
        battery_voltage: PA0,
        battery_current: PA1,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART3,
        rx: PD9,
        tx: PD8,
        rx_dma: DMA1_CH1,
        tx_dma: DMA1_CH3,
    }
    lights: LightParts {
        green: PC6,
        red: PB1,
    }
    watchdog: WatchdogParts {
        dog: IWDG,
    }
}

// What DMA reads and writes. All statics lie in DTCM, which DMA1 and DMA2 reach; `cargo xtask firmware` checks it.
static DMA_MOTORS: ConstStaticCell<EscBurst> = ConstStaticCell::new(EscBurst::IDLE);
static DMA_ANALOG: ConstStaticCell<Aligned<[u16; 6]>> = ConstStaticCell::new(Aligned([0; 6]));
static DMA_RECEIVER: ConstStaticCell<Aligned<[u8; 512]>> = ConstStaticCell::new(Aligned([0; 512]));

/// Starts the clocks and builds every port. Called once.
pub fn take(params: &Params) -> Board {
    let p = embassy_stm32::init(clocks());
    // SAFETY: called once, and no one else uses the core's cache control. Only the instruction cache: with the data
    // cache on, what DMA writes would have to be invalidated by hand.
    unsafe { cortex_m::Peripherals::steal() }.SCB.enable_icache();
    let parts = split_resources!(p);
    rails(parts.rails);
    let (receiver, telemetry) = receiver(parts.receiver);
    Board {
        watchdog: Dog::start(parts.watchdog.dog),
        motors: motors(parts.motors, Protocol::from_params(params)),
        imu: imu(parts.imu),
        arms: arms(parts.arms),
        analog: analog(parts.analog),
        servos: servos(parts.servos),
        receiver,
        telemetry,
        lights: lights(parts.lights),
    }
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
        divq: None,
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV4;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.ls = LsConfig::off();
    config
}

/// Switches the supplies on, and keeps the other chips on the sensor's bus from answering. For good: the pins are
/// leaked, since a pin that is dropped floats again.
fn rails(p: RailParts) {
    let hold = |pin: Peri<'static, AnyPin>, level| core::mem::forget(Output::new(pin, level, Speed::Low));
    hold(p.other_imu.into(), Level::High);
    hold(p.other_gyro.into(), Level::High);
    hold(p.other_accel.into(), Level::High);
    hold(p.sensors.into(), Level::High);
    hold(p.peripherals_off.into(), Level::Low);
    hold(p.high_power_off.into(), Level::Low);
}

fn imu(p: ImuParts) -> ImuPort {
    let mut config = spi::Config::default();
    config.mode = MODE_3;
    // The part takes 8 MHz; 6.75 MHz is the next divider below.
    config.frequency = Hertz(8_000_000);
    let device = Selected {
        bus: Spi::new(
            p.spi, p.clock, p.data_out, p.data_in, p.tx_dma, p.rx_dma, Irqs, config,
        ),
        select: Output::new(p.select, Level::High, Speed::VeryHigh),
    };
    let ready = ExtiInput::new(p.ready, p.ready_line, Pull::Down, Irqs);
    // Marking up, x to the right (ArduPilot: ROTATION_NONE after its driver's swap of x and y).
    Icm20689::new(
        device,
        ready,
        icm20689::Config::default(),
        Mounting::top_up(Heading::Right),
    )
}

fn motors(p: MotorParts, protocol: Protocol) -> MotorsPort {
    EscTimer::new(
        p.timer,
        (p.motor_1, p.motor_2, p.motor_3, p.motor_4),
        p.dma,
        Irqs,
        DMA_MOTORS.take(),
        protocol,
    )
}

/// Pins low, whatever the timer does: the last resort of a fault handler, callable at any time.
pub fn stop_motors() {
    super::stm32::pull_low(pac::GPIOE, [9, 11, 14, 14]);
    super::stm32::pull_low(pac::GPIOA, [10; 4]);
}

fn servos(p: ServoParts) -> ServosPort {
    let push_pull = OutputType::PushPull;
    let first = SimplePwm::new(
        p.first,
        None,
        Some(PwmPin::new(p.servo_1, push_pull)),
        Some(PwmPin::new(p.servo_2, push_pull)),
        None,
        hz(50),
        Default::default(),
    );
    ServoPairs::new(first, p.second, p.servo_3, p.servo_4)
}

fn arms(p: ArmParts) -> ArmsPort {
    let mut config = i2c::Config::default();
    config.frequency = Hertz(400_000);
    // The driver spins this long on a stretched clock; only the background can afford that.
    config.timeout = Duration::from_millis(3);
    let left = I2c::new(
        p.left,
        p.left_clock,
        p.left_data,
        p.left_tx_dma,
        p.left_rx_dma,
        Irqs,
        config,
    );
    let right = I2c::new(
        p.right,
        p.right_clock,
        p.right_data,
        p.right_tx_dma,
        p.right_rx_dma,
        Irqs,
        config,
    );
    ArmBuses::new(left, right, [bno055::Config::default(); 4])
}

fn analog(p: AnalogParts) -> AnalogPort {
    let channels = [
        p.fsr_1.degrade_adc(),
        p.fsr_2.degrade_adc(),
        p.fsr_3.degrade_adc(),
        p.fsr_4.degrade_adc(),
        p.battery_voltage.degrade_adc(),
        p.battery_current.degrade_adc(),
    ];
    AnalogInputs {
        converter: Converter::new(
            Adc::new(p.adc),
            pac::ADC1,
            channels,
            p.dma,
            Irqs,
            DMA_ANALOG.take(),
        ),
        scale: AnalogScale {
            extra_bits: 0,
            // 3.3 V full scale; divider and current sensor of the power module, as PX4 measured them.
            volts_per_count: 3.3 / 4095.0 * 18.1,
            amps_per_count: 3.3 / 4095.0 * 36.37,
        },
    }
}

fn receiver(p: ReceiverParts) -> (ReceiverPort, TelemetryPort) {
    let mut config = usart::Config::default();
    config.baudrate = 420_000;
    // Cannot fail: the rate is within the port's range.
    let Ok(uart) = Uart::new(p.uart, p.rx, p.tx, p.tx_dma, p.rx_dma, Irqs, config) else {
        panic!("receiver: the port refuses its configuration")
    };
    let (tx, rx) = uart.split();
    (
        ReceiverLine(rx.into_ring_buffered(&mut DMA_RECEIVER.take().0)),
        TelemetryLine(tx),
    )
}

fn lights(p: LightParts) -> Lights {
    Lights {
        state: (Output::new(p.green, Level::High, Speed::Low), Level::Low),
        fault: (Output::new(p.red, Level::High, Speed::Low), Level::Low),
        // The board's sounder needs a tone, not a level.
        buzzer: None,
    }
}
