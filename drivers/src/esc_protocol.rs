//! Protocol of the motor controllers: parameter `motor_protocol`.

use sophie_control::params::{MotorProtocol, Params};

use crate::dshot::Speed;
use crate::esc_pwm::{EscPulse, PulseRate};

/// Output to the motor controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EscProtocol {
    /// Digital frames.
    DShot(Speed),
    /// Pulses.
    Pulse(EscPulse),
}

impl EscProtocol {
    /// The protocol of `motor_protocol`.
    pub fn from_params(params: &Params) -> Self {
        let pulse = |rate| Self::Pulse(EscPulse::new(rate, params));
        match params.motor_protocol {
            MotorProtocol::Oneshot125 => pulse(PulseRate::OneShot125),
            MotorProtocol::Dshot150 => Self::DShot(Speed::Dshot150),
            MotorProtocol::Dshot300 => Self::DShot(Speed::Dshot300),
            MotorProtocol::Pwm => pulse(PulseRate::Standard),
            MotorProtocol::Dshot600 => Self::DShot(Speed::Dshot600),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_a_protocol_of_its_own() {
        let mut seen = heapless::Vec::<EscProtocol, 8>::new();
        for &motor_protocol in MotorProtocol::ALL {
            let params = Params {
                motor_protocol,
                ..Params::default()
            };
            let protocol = EscProtocol::from_params(&params);
            assert!(!seen.contains(&protocol), "{motor_protocol:?}: {protocol:?}");
            seen.push(protocol).unwrap();
        }
    }
}
