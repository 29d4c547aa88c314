//! An emulated processor with SOPHIE's sensors, lines and outputs on its pads.

use rigless::device::Level;
use rigless::machine::{Board, Target};
use rigless::mcu::Mcu;
use rigless::snapshot::{Error, Reader, Store, Writer};
use rigless::time::VirtualNanos;
use sophie_control::params::ArmBusSpeed;

use crate::chips::bno055::Bno055;
use crate::chips::dps310::Barometer;
use crate::chips::icm42688p::Imu;
use crate::chips::line::Line;
use crate::processor::chip::{Chip, Options};
use crate::processor::edge_probe::Edge;
use crate::processor::pads::{At, Pads};
use crate::processor::serial::Setup;

#[derive(Debug)]
pub struct Wired<C> {
    pub(crate) chip: C,
    pads: &'static Pads,
    core: rigless::emulator::CoreSpec,
    dividers: [f64; 4],
    barometer_silent: bool,
}

impl<C: Chip> Wired<C> {
    /// A board with `chip` wired as in `pads`, at `speed` instructions per clock cycle.
    ///
    /// # Errors
    /// The emulator cannot make it.
    pub fn new(mut chip: C, pads: &'static Pads, speed: f64) -> Result<Self, String> {
        chip.attach(pads);
        chip.set_options(Options::BrownOut);
        let core = chip.core(speed)?;
        Ok(Self {
            chip,
            pads,
            core,
            dividers: [1.0; 4],
            barometer_silent: false,
        })
    }

    /// Power-up: lines take their idle levels.
    pub fn power_up(&mut self, now: VirtualNanos) {
        for pin in self.pads.resting_high {
            self.chip.drive(now, *pin, Level::High);
        }
    }

    pub fn imu(&mut self) -> Option<&mut Imu> {
        self.chip.imu(self.pads.imu)
    }

    /// Converts from body axes to the inertial sensor's.
    pub fn on_imu(&self, vector: [f64; 3]) -> [f64; 3] {
        (self.pads.imu_axes)(vector)
    }

    pub fn silence_imu(&mut self, silent: bool) {
        self.chip.silence_imu(self.pads.imu, silent);
    }

    pub fn cut_data_ready(&mut self, cut: bool) {
        if let Some(imu) = self.imu() {
            imu.line_cut = cut;
        }
    }

    pub fn flip_imu_word(&mut self, mask: u64) {
        self.chip.flip_imu_word(self.pads.imu, mask);
    }

    /// Sensor of arm 0 to 3.
    pub fn arm(&mut self, arm: usize) -> Option<&mut Bno055> {
        let (bus, _) = *self.pads.arms.get(arm)?;
        self.chip.arm(bus, arm % 2)
    }

    pub fn silence_arm(&mut self, arm: usize, silent: bool) {
        if let Some((bus, _)) = self.pads.arms.get(arm) {
            self.chip.silence_on_bus(*bus, arm % 2, silent);
        }
    }

    pub fn barometer(&mut self) -> Option<&mut Barometer> {
        let (bus, nth) = self.pads.barometer?;
        self.chip.barometer(bus, nth)
    }

    /// Puts pressure (Pa) and temperature (°C) on the barometer; `None`: it answers no more.
    pub fn set_air(&mut self, air: Option<(f64, f64)>) {
        let Some((bus, nth)) = self.pads.barometer else {
            return;
        };
        if air.is_none() != self.barometer_silent {
            self.barometer_silent = air.is_none();
            self.chip.silence_on_bus(bus, nth, air.is_none());
        }
        if let (Some((pascal, celsius)), Some(part)) = (air, self.chip.barometer(bus, nth)) {
            part.feel(pascal, celsius);
        }
    }

    /// Stretches an arm bus's clock by `us` µs after each byte; false if the emulator cannot.
    pub fn hold_clock(&mut self, bus: usize, us: u32) -> bool {
        self.chip.hold_clock(bus, u64::from(us) * 1000)
    }

    /// Flags spurious bus errors on an arm bus, one in about `every` bytes; false if the part has no such errata.
    pub fn err_on_bus(&mut self, bus: usize, every: u32) -> bool {
        self.chip.err_on_bus(bus, every)
    }

    pub fn brown_out(&mut self) {
        self.chip.brown_out();
    }

    /// Sets the pads of pressure 1 to 4, battery voltage (V) and current (A), servo battery (V).
    pub fn set_analog(&mut self, values: [f64; 7]) {
        let mut values = values;
        for (pad, divider) in values.iter_mut().zip(self.dividers) {
            *pad /= divider;
        }
        for (channel, millivolts) in self.pads.analog(values) {
            self.chip.set_input(channel, millivolts);
        }
    }

    /// Adds a divider of 1:`divider` before the pin of pressure sensor `sensor`, 0 to 3.
    pub fn divide(&mut self, sensor: usize, divider: u32) {
        if let Some(own) = self.dividers.get_mut(sensor) {
            *own = f64::from(divider.max(1));
        }
    }

    /// Devices and their pins.
    pub fn outputs(&self) -> Vec<(String, At)> {
        let (port, pin) = self.pads.imu_select;
        let select = At(usize::from(port.as_bytes()[port.len() - 1] - b'A'), pin);
        let [state, fault, buzzer] = self.pads.signals;
        let motors = (1..).zip(self.pads.motors.pins);
        let servos = (1..).zip(self.pads.servos);
        motors
            .map(|(n, pin)| (format!("motor {n}"), pin))
            .chain(servos.map(|(n, servo)| (format!("servo {n}"), servo.pin)))
            .chain([
                ("state light".to_owned(), state),
                ("fault light".to_owned(), fault),
                ("buzzer".to_owned(), buzzer),
                ("select of the inertial sensor".to_owned(), select),
            ])
            .collect()
    }

    pub fn drives(&mut self, now: VirtualNanos, pin: At) -> bool {
        self.chip.drives(now, pin)
    }

    pub fn pulls_up(&mut self, now: VirtualNanos, pin: At) -> bool {
        self.chip.pulls_up(now, pin)
    }

    pub fn receiver(&mut self) -> Option<&mut Line> {
        self.chip.line(self.pads.receiver)
    }

    pub fn receiver_noise(&mut self, per_million: u32) {
        self.chip.noisy_line(self.pads.receiver, per_million);
    }

    pub fn console(&mut self) -> Option<&mut Line> {
        self.chip.line(self.pads.console)
    }

    pub fn mavlink(&mut self) -> Option<&mut Line> {
        self.chip.line(self.pads.mavlink)
    }

    /// Port of the flow and range module.
    pub fn ground(&mut self) -> Option<&mut Line> {
        self.chip.line(self.pads.ground)
    }

    pub fn motor_edges(&mut self) -> Vec<Edge> {
        self.chip.motor_edges()
    }

    /// Whether the timer drives the motor's pin.
    pub fn motors_driven(&mut self, now: VirtualNanos) -> [bool; 4] {
        let motors = self.pads.motors;
        motors
            .pins
            .map(|pin| self.chip.function(now, pin) == Some(motors.function))
    }

    /// High time and period, ns, if any.
    pub fn servo_pulses(&mut self, now: VirtualNanos) -> [Option<(u64, u64)>; 4] {
        self.pads.servos.map(|servo| {
            let driven = self.chip.function(now, servo.pin) == Some(servo.function);
            let pulse = self.chip.servo_pulse(servo)?;
            (driven && pulse.0 > 0).then_some(pulse)
        })
    }

    pub fn signals(&mut self, now: VirtualNanos) -> [bool; 3] {
        self.pads.signals.map(|pin| self.chip.is_high(now, pin))
    }

    /// First words of the parameter sectors as ArduPilot leaves them.
    pub fn foreign(&self) -> &'static [u64] {
        self.pads.foreign
    }

    /// Pins with a wrong function, a receiver's port that differs from `receiver`, MAVLink's from [`Setup::MAVLINK`], with
    /// the flow module's from [`Setup::GROUND`], and arm buses of another speed.
    pub fn miswired(
        &mut self,
        now: VirtualNanos,
        receiver: Setup,
        flow_module: bool,
        speed: ArmBusSpeed,
    ) -> Vec<(String, String)> {
        let mut found = Vec::new();
        let lines = [
            ("receiver", self.pads.receiver, receiver),
            ("MAVLink", self.pads.mavlink, Setup::MAVLINK),
        ];
        let module = flow_module.then_some(("flow and range", self.pads.ground, Setup::GROUND));
        for (name, port, wired) in lines.into_iter().chain(module) {
            let port = self.chip.serial_setup(port);
            if !wired.fits(&port) {
                found.push((name.to_owned(), format!("is {port}, wired for {wired}")));
            }
        }
        if let Some(wrong) = self.chip.pll_ranges() {
            found.push(("RCC".to_owned(), wrong));
        }
        for bus in 0..2 {
            if let Some(wrong) = self.chip.bus_times(bus, speed) {
                found.push((format!("I2C{}", bus + 1), wrong));
            }
        }
        for (pin, wanted) in self.pads.functions(!receiver.parity, flow_module) {
            let function = self.chip.function(now, pin);
            if function != Some(wanted) {
                let carried = function.map_or("none".to_owned(), |f| f.to_string());
                found.push((
                    pin.to_string(),
                    format!("carries alternate function {carried}, wired for {wanted}"),
                ));
            }
        }
        found
    }
}

impl<C: Chip> Board for Wired<C> {
    fn name(&self) -> &'static str {
        self.pads.name
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![self.pads.part]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.chip)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        vec![Target::new(self.pads.part, &mut self.chip, self.core.clone())]
    }
}

// Runs take no snapshots.
impl<C> Store for Wired<C> {
    fn store(&self, _: &mut Writer) -> Result<(), Error> {
        Err(Error::Failed)
    }

    fn load(&mut self, _: &mut Reader) -> Result<(), Error> {
        Err(Error::Failed)
    }
}
