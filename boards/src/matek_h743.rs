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
use embassy_stm32::gpio::Level;
use embassy_stm32::time::mhz;
use embassy_stm32::{Peri, bind_interrupts, dma, exti, i2c, interrupt, pac, peripherals, rcc, usart, usb};
use embassy_sync::mutex::Mutex;
use sophie_control::params::Params;
use sophie_drivers::arm_buses::ArmBuses;
use sophie_drivers::bno055;
use sophie_drivers::dps310::Dps310;
use sophie_drivers::icm42688p;
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_tasks::links::last_value::Raw;
use static_cell::StaticCell;

use crate::cortex_m::levels_on;
use crate::stm32::{
    ArmBus, BusErrors, EscTimer, Lamp, Lights, ParamFlash, PortLevels, ReadyStamp, ServoTimer, WatchErrors,
    Wiring, i2c_bus, pad, ports,
};

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

/// The bus of arm sensors 3 and 4 and of the barometer: who waits for it waits for one transaction, half a millisecond.
type RightBus = I2cDevice<'static, Raw, ArmBus<RightArms>>;
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

ports! { |parts, params|
    name: "matek-h743";
    time: TIM2;
    storage: ParamFlash<0x2_0000> = ParamFlash::new(parts.storage.flash);
    imu: icm42688p::Config;
    // On the underside, turned by half a turn about the vertical (ArduPilot: ROTATION_YAW_180).
    mounting: Mounting::top_down(Heading::Back);
    let right = &*RIGHT_BUS.init(Mutex::new(ArmBus::new(parts.right_arms, params.arm_bus_khz)));
    arms: ArmBuses<ArmBus<LeftArms>, RightBus> = ArmBuses::new(
        ArmBus::new(parts.left_arms, params.arm_bus_khz),
        I2cDevice::new(right),
        [bno055::Config::default(); 4],
    );
    barometer: Dps310<RightBus> = Dps310::at(I2cDevice::new(right));
    motors: EscTimer<peripherals::TIM4, peripherals::DMA1_CH0, Irqs>;
    servos: ServoTimer<peripherals::TIM5> = {
        let s = parts.servos;
        ServoTimer::new(s.timer, (s.servo_1, s.servo_2, s.servo_3, s.servo_4), params)
    };
    analog: DMA2_CH4;
    lights: Lights<Lamp> = Lights {
        state: Lamp::new(parts.lights.green, Level::Low),
        fault: Lamp::new(parts.lights.blue, Level::Low),
        buzzer: Lamp::new(parts.lights.buzzer, Level::High),
    };
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

/// The motors' pins, low.
pub const MOTORS_LOW: [PortLevels; 1] = [PortLevels::new(pac::GPIOD, &[12, 13, 14, 15], &[])];

/// What the outputs are until their ports take them: motors, servos and buzzer low, the inertial sensor not selected.
pub const FIRST_LEVELS: [PortLevels; 3] = [
    MOTORS_LOW[0],
    PortLevels::new(pac::GPIOA, &[0, 1, 2, 3, 15], &[]),
    PortLevels::new(pac::GPIOC, &[], &[15]),
];
