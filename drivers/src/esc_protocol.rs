//! Which protocol the motor controllers speak: the parameter `motor_protocol`.

use sophie_control::params::Params;

use crate::dshot::Speed;
use crate::esc_pwm::EscPulse;

/// What the motor controllers understand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// Digital frames.
    DShot(Speed),
    /// Pulses.
    Pulse(EscPulse),
    /// Nothing: the pins stay low.
    Off,
}

impl Protocol {
    /// The protocol that `motor_protocol` names. The table of parameters refuses every other number; should one get
    /// here all the same, the motors get nothing, since a controller may take a wrong protocol for full throttle.
    pub fn from_params(params: &Params) -> Self {
        match params.motor_protocol as u32 {
            125 => Self::Pulse(EscPulse::OneShot125),
            150 => Self::DShot(Speed::Dshot150),
            300 => Self::DShot(Speed::Dshot300),
            400 => Self::Pulse(EscPulse::Standard),
            600 => Self::DShot(Speed::Dshot600),
            _ => Self::Off,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_a_protocol_of_its_own_and_nothing_else_is_one() {
        let row = Params::TABLE.iter().find(|row| row.name == "motor_protocol");
        let choices = row.unwrap().choices;
        let mut seen = heapless::Vec::<Protocol, 8>::new();
        for &choice in choices {
            let mut params = Params::default();
            params.set("motor_protocol", choice).unwrap();
            let protocol = Protocol::from_params(&params);
            assert!(
                protocol != Protocol::Off && !seen.contains(&protocol),
                "{choice}: {protocol:?}"
            );
            seen.push(protocol).unwrap();
        }
        for wrong in [0.0, 200.0, -300.0, f32::NAN, f32::INFINITY] {
            let params = Params {
                motor_protocol: wrong,
                ..Params::default()
            };
            assert!(Protocol::from_params(&params) == Protocol::Off, "{wrong}");
        }
    }
}
