//! A custom board with an STM32F405RG at 168 MHz: the smallest chip that holds the stack, and the file to copy for a
//! board of one's own.
//!
//! | what | peripheral | DMA stream | pins |
//! |---|---|---|---|
//! | inertial sensor | SPI1, EXTI4 | DMA2 2 and 3 | PA5 clock, PA6 in, PA7 out, PA4 select, PC4 data ready |
//! | motors 1 to 4 | TIM8 | DMA2 1 | PC6, PC7, PC8, PC9 |
//! | servos 1 to 4 | TIM3 | none | PB4, PB5, PB0, PB1 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 0 and 6, 2 and 7 | PB8 PB9, PB10 PB11 |
//! | pressure 1 to 4, battery | ADC1 | DMA2 4 | PC0 to PC3; PA0 voltage, PA1 current |
//! | receiver | USART1 | DMA2 5 and 7 | PA10 in, PA9 out |
//! | lights, buzzer | | none | PC10 state, PC11 fault, PC12 |
//! | time | TIM5 | none | |
//!
//! Here a DMA stream serves few requests (RM0090 §10.3.3), and two peripherals must not share one: the compiler refuses a
//! stream that does not serve its peripheral, and a stream that is used twice.

use assign_resources::assign_resources;
use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{Level, Output, OutputType, Pull, Speed};
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
#[cfg(feature = "imu-icm20689")]
use sophie_drivers::icm20689 as part;
#[cfg(not(feature = "imu-icm20689"))]
use sophie_drivers::icm42688p as part;
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_drivers::spi_imu::SpiImu;
use static_cell::ConstStaticCell;

use super::Board;
use super::stm32::{
    Aligned, AnalogInputs, AnalogScale, Converter, Dog, EscBurst, EscTimer, Lights, Protocol, ReceiverLine,
    Selected, ServoTimer, TelemetryLine,
};

/// Name in the log.
pub const NAME: &str = "f405";

/// The vehicle's inertial sensor.
pub type ImuPort = SpiImu<part::Config, Selected, ExtiInput<'static, Async>>;
/// The arms' inertial sensors.
pub type ArmsPort = ArmBuses<I2c<'static, Async, i2c::Master>, I2c<'static, Async, i2c::Master>>;
/// Pressure sensors and battery.
pub type AnalogPort = AnalogInputs<Converter<peripherals::ADC1, peripherals::DMA2_CH4, Irqs>>;
/// The motors.
pub type MotorsPort = EscTimer<peripherals::TIM8, peripherals::DMA2_CH1, Irqs>;
/// The tendon servos.
pub type ServosPort = ServoTimer<peripherals::TIM3>;
/// From the receiver.
pub type ReceiverPort = ReceiverLine;
/// To the receiver.
pub type TelemetryPort = TelemetryLine;
/// The watchdog.
pub type WatchdogPort = Dog<peripherals::IWDG>;

crate::levels_on!(CAN1_TX, CAN2_TX);

bind_interrupts! {
    /// Which handler serves which vector.
    pub struct Irqs {
        DMA1_STREAM0 => dma::InterruptHandler<peripherals::DMA1_CH0>;
        DMA1_STREAM2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
        DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
        DMA1_STREAM7 => dma::InterruptHandler<peripherals::DMA1_CH7>;
        DMA2_STREAM1 => dma::InterruptHandler<peripherals::DMA2_CH1>;
        DMA2_STREAM2 => dma::InterruptHandler<peripherals::DMA2_CH2>;
        DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
        DMA2_STREAM4 => dma::InterruptHandler<peripherals::DMA2_CH4>;
        DMA2_STREAM5 => dma::InterruptHandler<peripherals::DMA2_CH5>;
        DMA2_STREAM7 => dma::InterruptHandler<peripherals::DMA2_CH7>;
        EXTI4 => exti::InterruptHandler<interrupt::typelevel::EXTI4>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
        I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>;
        I2C2_ER => i2c::ErrorInterruptHandler<peripherals::I2C2>;
        USART1 => usart::InterruptHandler<peripherals::USART1>;
    }
}

assign_resources! {
    imu: ImuParts {
        spi: SPI1,
        clock: PA5,
        data_in: PA6,
        data_out: PA7,
        select: PA4,
        tx_dma: DMA2_CH3,
        rx_dma: DMA2_CH2,
        ready: PC4,
        ready_line: EXTI4,
    }
    motors: MotorParts {
        timer: TIM8,
        motor_1: PC6,
        motor_2: PC7,
        motor_3: PC8,
        motor_4: PC9,
        dma: DMA2_CH1,
    }
    servos: ServoParts {
        timer: TIM3,
        servo_1: PB4,
        servo_2: PB5,
        servo_3: PB0,
        servo_4: PB1,
    }
    arms: ArmParts {
        left: I2C1,
        left_clock: PB8,
        left_data: PB9,
        left_tx_dma: DMA1_CH6,
        left_rx_dma: DMA1_CH0,
        right: I2C2,
        right_clock: PB10,
        right_data: PB11,
        right_tx_dma: DMA1_CH7,
        right_rx_dma: DMA1_CH2,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PC0,
        fsr_2: PC1,
        fsr_3: PC2,
        fsr_4: PC3,
        battery_voltage: PA0,
        battery_current: PA1,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART1,
        rx: PA10,
        tx: PA9,
        rx_dma: DMA2_CH5,
        tx_dma: DMA2_CH7,
    }
    lights: LightParts {
        state: PC10,
        fault: PC11,
        buzzer: PC12,
    }
    watchdog: WatchdogParts {
        dog: IWDG,
    }
}

// What DMA reads and writes. All statics lie in SRAM1 and SRAM2, which DMA1 and DMA2 reach; `cargo xtask firmware` checks it.
static DMA_MOTORS: ConstStaticCell<EscBurst> = ConstStaticCell::new(EscBurst::IDLE);
static DMA_ANALOG: ConstStaticCell<Aligned<[u16; 6]>> = ConstStaticCell::new(Aligned([0; 6]));
static DMA_RECEIVER: ConstStaticCell<Aligned<[u8; 512]>> = ConstStaticCell::new(Aligned([0; 512]));

/// Starts the clocks and builds every port. Called once.
pub fn take(params: &Params) -> Board {
    let p = embassy_stm32::init(clocks());
    let parts = split_resources!(p);
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

/// 8 MHz crystal; core 168 MHz, buses 42 and 84 MHz, timers 84 and 168 MHz.
fn clocks() -> embassy_stm32::Config {
    use rcc::*;

    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: mhz(8),
        mode: HseMode::Oscillator,
    });
    rcc.pll_src = PllSource::HSE;
    rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
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

fn imu(p: ImuParts) -> ImuPort {
    let mut config = spi::Config::default();
    config.mode = MODE_3;
    // The ICM-20689 takes 8 MHz, the ICM-42688-P 24 MHz. Dividers of 84 MHz: 5.25 and 10.5 MHz.
    config.frequency = Hertz(if cfg!(feature = "imu-icm20689") {
        8_000_000
    } else {
        12_500_000
    });
    let device = Selected {
        bus: Spi::new(
            p.spi, p.clock, p.data_out, p.data_in, p.tx_dma, p.rx_dma, Irqs, config,
        ),
        select: Output::new(p.select, Level::High, Speed::VeryHigh),
    };
    let ready = ExtiInput::new(p.ready, p.ready_line, Pull::Down, Irqs);
    // Marking up, x forward; a board of one's own says here how it is.
    SpiImu::new(
        device,
        ready,
        part::Config::default(),
        Mounting::top_up(Heading::Forward),
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
    super::stm32::pull_low(pac::GPIOC, [6, 7, 8, 9]);
}

fn servos(p: ServoParts) -> ServosPort {
    let push_pull = OutputType::PushPull;
    ServoTimer::new(SimplePwm::new(
        p.timer,
        Some(PwmPin::new(p.servo_1, push_pull)),
        Some(PwmPin::new(p.servo_2, push_pull)),
        Some(PwmPin::new(p.servo_3, push_pull)),
        Some(PwmPin::new(p.servo_4, push_pull)),
        hz(50),
        Default::default(),
    ))
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
            // 3.3 V full scale; divider 1:11 and 40 A/V, as on most boards of this kind.
            volts_per_count: 3.3 / 4095.0 * 11.0,
            amps_per_count: 3.3 / 4095.0 * 40.0,
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
        state: (Output::new(p.state, Level::Low, Speed::Low), Level::High),
        fault: (Output::new(p.fault, Level::Low, Speed::Low), Level::High),
        buzzer: Some((Output::new(p.buzzer, Level::Low, Speed::Low), Level::High)),
    }
}
