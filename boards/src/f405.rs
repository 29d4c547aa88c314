//! A custom board with an STM32F405RG at 168 MHz: the smallest chip that holds the stack, and the file to copy for a
//! board of one's own.
//!
//! | what | peripheral | DMA stream | pins |
//! |---|---|---|---|
//! | inertial sensor | SPI1, EXTI4 | DMA2 2 and 3 | PA5 clock, PA6 in, PA7 out, PA4 select, PC4 data ready |
//! | motors 1 to 4 | TIM8 | DMA2 1 | PC6, PC7, PC8, PC9 |
//! | servos 1 and 2, 3 and 4 | TIM4, TIM12 | none | PB6, PB7; PB14, PB15 |
//! | arm sensors 1 and 2, 3 and 4 | I2C1, I2C2 | DMA1 0 and 6, 2 and 7 | PB8 PB9, PB10 PB11 |
//! | pressure 1 to 4, battery, servo battery | ADC1 | DMA2 4 | PC0 to PC3; PA0 voltage, PA1 current; PB0 |
//! | receiver | USART1 | DMA2 5 and 7 | PA10 in, PA9 out |
//! | console | USART2 | none | PA3 in, PA2 out |
//! | MAVLink | USART3 | none | PC11 in, PC10 out |
//! | flow and range | UART5 | none | PD2 in, PC12 unused |
//! | USB | OTG_FS | none | PA12 plus, PA11 minus |
//! | lights, buzzer | | none | PB12 state, PB13 fault, PA8 |
//! | parameters | flash | none | sectors 1 and 2 |
//! | time | TIM5 | none | |
//!
//! Here a DMA stream serves few requests (RM0090 §10.3.3), and two peripherals must not share one: the compiler refuses a
//! stream that does not serve its peripheral, and a stream that is used twice.

use assign_resources::assign_resources;
use embassy_stm32::gpio::Level;
use embassy_stm32::time::mhz;
use embassy_stm32::{Peri, bind_interrupts, dma, exti, i2c, interrupt, pac, peripherals, rcc, usart, usb};
use sophie_control::params::Params;
#[cfg(feature = "imu-icm20689")]
use sophie_drivers::icm20689 as part;
#[cfg(not(feature = "imu-icm20689"))]
use sophie_drivers::icm42688p as part;
use sophie_drivers::mounting::{Heading, Mounting};

use crate::cortex_m::levels_on;
use crate::stm32::{
    EscTimer, Lamp, Lights, ParamFlash, PortLevels, ReadyStamp, ServoPairs, Wiring, i2c_bus, pad, ports,
};

/// Flash sectors that hold parameters, a bit each.
const PARAM_SECTORS: u32 = 1 << 1 | 1 << 2;
/// The parameters' defaults of this board: 1:11 and 40 A/V, as on most boards of this kind.
static DEFAULTS: Params = Params {
    battery_divider: 11.0,
    battery_a_per_v: 40.0,
    ..Params::DEFAULT
};

/// What `cargo xtask rig` joins (hil/README.md).
pub const WIRING: Wiring = Wiring {
    core_hz: 168_000_000,
    motor: [pad("PC6", pac::GPIOC, 6), pad("PB14", pac::GPIOB, 14)],
    servo: [pad("PB6", pac::GPIOB, 6), pad("PB15", pac::GPIOB, 15)],
    receiver: [pad("PA9", pac::GPIOA, 9), pad("PA10", pac::GPIOA, 10)],
    divider: (pad("PC1", pac::GPIOC, 1), 1),
};

levels_on!(CAN1_TX, CAN2_TX);
i2c_bus!(LeftArms, Irqs, I2C1);
i2c_bus!(RightArms, Irqs, I2C2);

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
        EXTI4 => ReadyStamp, exti::InterruptHandler<interrupt::typelevel::EXTI4>;
        I2C1_EV => i2c::EventInterruptHandler<peripherals::I2C1>;
        I2C1_ER => i2c::ErrorInterruptHandler<peripherals::I2C1>;
        I2C2_EV => i2c::EventInterruptHandler<peripherals::I2C2>;
        I2C2_ER => i2c::ErrorInterruptHandler<peripherals::I2C2>;
        OTG_FS => usb::InterruptHandler<peripherals::USB_OTG_FS>;
        UART5 => usart::BufferedInterruptHandler<peripherals::UART5>;
        USART1 => usart::InterruptHandler<peripherals::USART1>;
        USART2 => usart::BufferedInterruptHandler<peripherals::USART2>;
        USART3 => usart::BufferedInterruptHandler<peripherals::USART3>;
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
        first: TIM4,
        servo_1: PB6,
        servo_2: PB7,
        second: TIM12,
        servo_3: PB14,
        servo_4: PB15,
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
        clock: PB10,
        data: PB11,
        tx_dma: DMA1_CH7,
        rx_dma: DMA1_CH2,
    }
    analog: AnalogParts {
        adc: ADC1,
        fsr_1: PC0,
        fsr_2: PC1,
        fsr_3: PC2,
        fsr_4: PC3,
        battery_voltage: PA0,
        battery_current: PA1,
        servo_battery: PB0,
        dma: DMA2_CH4,
    }
    receiver: ReceiverParts {
        uart: USART1,
        rx: PA10,
        tx: PA9,
        rx_dma: DMA2_CH5,
        tx_dma: DMA2_CH7,
    }
    console: ConsoleParts {
        uart: USART2,
        rx: PA3,
        tx: PA2,
    }
    mavlink: MavlinkParts {
        uart: USART3,
        rx: PC11,
        tx: PC10,
    }
    ground: GroundParts {
        uart: UART5,
        rx: PD2,
        tx: PC12,
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
        state: PB12,
        fault: PB13,
        buzzer: PA8,
    }
    watchdog: WatchdogParts {
        dog: IWDG,
    }
}

ports! { |parts, params|
    name: "f405";
    time: TIM5;
    storage: ParamFlash<0x4000> = ParamFlash::new(parts.storage.flash);
    // The next divider of 84 MHz below: 21 MHz, and 5.25 MHz for the ICM-20689.
    imu: part::Config;
    // Marking up, x forward; a board of one's own says here how it is.
    mounting: Mounting::top_up(Heading::Forward);
    motors: EscTimer<peripherals::TIM8, peripherals::DMA2_CH1, Irqs>;
    servos: ServoPairs<peripherals::TIM4, peripherals::TIM12> = {
        let s = parts.servos;
        ServoPairs::new(s.first, (s.servo_1, s.servo_2), s.second, (s.servo_3, s.servo_4), params)
    };
    analog: DMA2_CH4;
    lights: Lights<Lamp> = Lights {
        state: Lamp::new(parts.lights.state, Level::High),
        fault: Lamp::new(parts.lights.fault, Level::High),
        buzzer: Lamp::new(parts.lights.buzzer, Level::High),
    };
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
        // USB: 48 MHz.
        divq: Some(PllQDiv::DIV7),
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV4;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.ls = LsConfig::off();
    config
}

/// The motors' pins, low.
pub const MOTORS_LOW: [PortLevels; 1] = [PortLevels::new(pac::GPIOC, &[6, 7, 8, 9], &[])];

/// What the outputs are until their ports take them: motors, servos and buzzer low, the inertial sensor not selected.
pub const FIRST_LEVELS: [PortLevels; 3] = [
    MOTORS_LOW[0],
    PortLevels::new(pac::GPIOB, &[6, 7, 14, 15], &[]),
    PortLevels::new(pac::GPIOA, &[8], &[4]),
];
