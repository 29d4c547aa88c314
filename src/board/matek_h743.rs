//! Matek H743 (WING, SLIM, MINI; V3 with the ICM-42688-P): STM32H743VI at 400 MHz. The reference board.
//!
//! | what | peripheral | DMA stream | pads |
//! |---|---|---|---|
//! | inertial sensor | SPI1, EXTI2 | DMA2 2 and 3 | on board |
//! | motors 1 to 4 | TIM4 | DMA1 0 | S7, S8, S9, S10 |
//! | servos 1 to 4 | TIM5 | none | S3, S4, S5, S6 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 1 to 4 | CL1 DA1, CL2 DA2 |
//! | pressure 1 to 4, battery | ADC1 | DMA2 4 | AirS, RSSI, VB2, CU2; on board |
//! | receiver | USART6 | DMA2 0 and 1 | RX6, TX6 |
//! | time | TIM2 | none | |
//!
//! Motors and servos each have a timer of their own: a motor frame stops its timer between frames, and a servo
//! wants 50 Hz. Pins are those of the board's maker as Betaflight (`MATEKH743`) and ArduPilot (`MatekH743`) name them.

use assign_resources::assign_resources;
use embassy_stm32::adc::{Adc, AdcChannel, SampleTime};
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
use sophie_drivers::icm42688p::{self, Icm42688p};
use sophie_drivers::mounting::{Heading, Mounting};
use static_cell::ConstStaticCell;

use super::Board;
use super::stm32::{
    Aligned, AnalogInputs, AnalogScale, Converter, Dog, EscBurst, EscTimer, Lights, Protocol, ReceiverLine,
    Selected, ServoTimer, TelemetryLine,
};

/// Name in the log.
pub const NAME: &str = "matek-h743";

/// The vehicle's inertial sensor.
pub type ImuPort = Icm42688p<Selected, ExtiInput<'static, Async>>;
/// The arms' inertial sensors.
pub type ArmsPort = ArmBuses<I2c<'static, Async, i2c::Master>, I2c<'static, Async, i2c::Master>>;
/// Pressure sensors and battery.
pub type AnalogPort = AnalogInputs<Converter<peripherals::ADC1, peripherals::DMA2_CH4, Irqs>>;
/// The motors.
pub type MotorsPort = EscTimer<peripherals::TIM4, peripherals::DMA1_CH0, Irqs>;
/// The tendon servos.
pub type ServosPort = ServoTimer<peripherals::TIM5>;
/// From the receiver.
pub type ReceiverPort = ReceiverLine;
/// To the receiver.
pub type TelemetryPort = TelemetryLine;
/// The watchdog.
pub type WatchdogPort = Dog<peripherals::IWDG1>;

crate::levels_on!(SAI3, SAI4);

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
        EXTI2 => exti::InterruptHandler<interrupt::typelevel::EXTI2>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
        I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>;
        I2C2_ER => i2c::ErrorInterruptHandler<peripherals::I2C2>;
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
    arms: ArmParts {
        left: I2C1,
        left_clock: PB6,
        left_data: PB7,
        left_tx_dma: DMA1_CH1,
        left_rx_dma: DMA1_CH2,
        right: I2C2,
        right_clock: PB10,
        right_data: PB11,
        right_tx_dma: DMA1_CH3,
        right_rx_dma: DMA1_CH4,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PC4,
        fsr_2: PC5,
        fsr_3: PA4,
        fsr_4: PA7,
        battery_voltage: PC0,
        battery_current: PC1,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART6,
        rx: PC7,
        tx: PC6,
        rx_dma: DMA2_CH0,
        tx_dma: DMA2_CH1,
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

// What DMA reads and writes. All statics lie in AXI SRAM, which DMA1 and DMA2 reach; `cargo xtask firmware` checks it.
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

/// 8 MHz crystal; core 400 MHz, buses 100 MHz, timers 200 MHz, SPI1 100 MHz, converter 50 MHz (halved inside).
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
        mul: PllMul::MUL50,
        divp: Some(PllDiv::DIV8),
        divq: None,
        divr: None,
    };
    rcc.pll1 = Some(Pll {
        mul: PllMul::MUL100,
        divp: Some(PllDiv::DIV2),
        divq: Some(PllDiv::DIV8),
        ..pll
    });
    rcc.pll2 = Some(pll);
    // Not used, but embassy-stm32 0.6 sets the sources of all three from the last one configured: left out, it would
    // take the source away from the running first one.
    rcc.pll3 = Some(pll);
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    rcc.ls = LsConfig::off();
    rcc.mux.adcsel = mux::Adcsel::PLL2_P;
    config
}

fn imu(p: ImuParts) -> ImuPort {
    let mut config = spi::Config::default();
    config.mode = MODE_3;
    // The part takes 24 MHz; the next divider below.
    config.frequency = Hertz(12_500_000);
    let device = Selected {
        bus: Spi::new(
            p.spi, p.clock, p.data_out, p.data_in, p.tx_dma, p.rx_dma, Irqs, config,
        ),
        select: Output::new(p.select, Level::High, Speed::VeryHigh),
    };
    let ready = ExtiInput::new(p.ready, p.ready_line, Pull::Down, Irqs);
    // On the underside, turned by half a turn about the vertical (ArduPilot: ROTATION_YAW_180).
    Icm42688p::new(
        device,
        ready,
        icm42688p::Config::default(),
        Mounting::top_down(Heading::Back),
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
    super::stm32::pull_low(pac::GPIOD, [12, 13, 14, 15]);
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
        converter: Converter {
            adc: Adc::new(p.adc),
            channels,
            sample_time: SampleTime::CYCLES387_5,
            dma: p.dma,
            irqs: Irqs,
            buffer: DMA_ANALOG.take(),
        },
        scale: AnalogScale {
            extra_bits: 4,
            // 3.3 V full scale; divider 1:11 and 40 A/V as the maker states.
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
        state: (Output::new(p.green, Level::High, Speed::Low), Level::Low),
        fault: (Output::new(p.blue, Level::High, Speed::Low), Level::Low),
        buzzer: Some((Output::new(p.buzzer, Level::Low, Speed::Low), Level::High)),
    }
}
