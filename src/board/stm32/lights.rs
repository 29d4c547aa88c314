//! Lights and buzzer.

use embassy_stm32::gpio::{Level, Output};

/// Two lights and a buzzer, each with the level that switches it on.
pub struct Lights {
    /// State of the vehicle.
    pub state: (Output<'static>, Level),
    /// Something is wrong.
    pub fault: (Output<'static>, Level),
    /// Buzzer, where the board has one.
    pub buzzer: Option<(Output<'static>, Level)>,
}

impl Lights {
    /// Switches all three.
    pub fn show(&mut self, state: bool, fault: bool, buzzer: bool) {
        switch(&mut self.state, state);
        switch(&mut self.fault, fault);
        if let Some(output) = &mut self.buzzer {
            switch(output, buzzer);
        }
    }
}

fn switch((output, on_level): &mut (Output<'static>, Level), on: bool) {
    output.set_level(Level::from(on == (*on_level == Level::High)));
}
