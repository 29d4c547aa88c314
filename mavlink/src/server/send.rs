//! Sending: the most urgent frame that is due and within the budget.

use mavlink_core::MessageData;
use sophie_control::mode::Mode;

use super::Server;
use crate::inputs::Inputs;
use crate::services::answer::Answer;
use crate::services::files::{GENERAL_CRC, GENERAL_URI};
use crate::services::streams::{STREAMS, frame_bytes};
use crate::services::telemetry as make;
use crate::vehicle::Vehicle;
use crate::wire::budget::RESERVE;
use crate::wire::frame::{Encoder, SIGNATURE};
use crate::wire::signing::{Refused, Signing};
use sophie_dialect::*;

impl Server {
    /// The next frame that is due and within the budget at `now`, µs since the start.
    pub fn send(
        &mut self,
        now: u64,
        vehicle: &Vehicle,
        signing: &mut Signing,
        inputs: &mut Inputs,
    ) -> Option<&[u8]> {
        self.encoder.leave_room(signing.signs());
        self.budget
            .add_to_each(if signing.signs() { SIGNATURE as u32 } else { 0 });
        self.budget.refill(now);
        if let Some(refused) = signing.report(now) {
            self.say_refused(refused);
        }
        if self.mode != vehicle.mode() {
            self.mode = vehicle.mode();
            self.services.schedule.hurry(HEARTBEAT_DATA::ID);
            self.services.schedule.hurry(CURRENT_MODE_DATA::ID);
        }
        let bytes = self
            .send_heartbeat(now, vehicle)
            .or_else(|| self.send_answer(now, vehicle, inputs))
            .or_else(|| self.send_text(vehicle, signing.notice()))
            .or_else(|| self.send_console_by_turns(now, vehicle))
            .or_else(|| self.send_file())
            .or_else(|| self.send_listed())?;
        self.budget.spend(bytes);
        signing.sign(self.encoder.frame_mut(), self.line, now);
        Some(self.encoder.frame())
    }

    fn say_refused(&mut self, refused: Refused) {
        let Refused { unsigned, wrong, old } = refused;
        self.services.texts.say(
            MavSeverity::MAV_SEVERITY_WARNING,
            format_args!("refused: {unsigned} unsigned, {wrong} wrong, {old} old"),
        );
    }

    /// Before all else, so that a flood of requests cannot make the vehicle look lost.
    fn send_heartbeat(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        let room = self.budget.allows(frame_bytes::<HEARTBEAT_DATA>());
        let due = room && self.services.schedule.take(HEARTBEAT_DATA::ID, now);
        due.then(|| self.encoder.encode(&make::heartbeat(vehicle)))
    }

    fn send_answer(&mut self, now: u64, vehicle: &Vehicle, inputs: &mut Inputs) -> Option<u32> {
        if !self.budget.allows(self.services.answers.front()?.bytes()) {
            return None;
        }
        let answer = self.services.answers.pop_front()?;
        let encoder = &mut self.encoder;
        match answer {
            Answer::Ack {
                command,
                result,
                progress,
                to,
            } => Some(encoder.encode(&COMMAND_ACK_DATA {
                command,
                result: result as u8,
                progress,
                target_system: to.system,
                target_component: to.component,
                ..COMMAND_ACK_DATA::DEFAULT
            })),
            Answer::Ping(ping) => Some(encoder.encode(&ping)),
            Answer::Timesync(sync) => Some(encoder.encode(&sync)),
            Answer::AskTime(peer) => inputs.clocks.ask(peer, now).then(|| {
                encoder.encode(&TIMESYNC_DATA {
                    tc1: 0,
                    ts1: i64::try_from(now.saturating_mul(1000)).unwrap_or(i64::MAX),
                    target_system: peer.system,
                    target_component: peer.component,
                })
            }),
            Answer::Interval { id, interval_us } => Some(encoder.encode(&MESSAGE_INTERVAL_DATA {
                interval_us,
                message_id: id,
            })),
            Answer::Parameter(place) => Some(encoder.encode(&self.services.parameters.value(place)?)),
            Answer::Row => Some(encoder.encode(&self.services.row_message()?)),
            Answer::Arming => Some(encoder.encode(&make::arming(vehicle, (now / 1000) as u32)?)),
            Answer::Component => Some(encoder.encode(&make::component(vehicle, (now / 1000) as u32))),
            Answer::CalibrationResult => {
                let result = self.services.calibrations.result.clone()?;
                Some(encoder.encode(&SOPHIE_CALIBRATION_RESULT_DATA {
                    time_boot_ms: (now / 1000) as u32,
                    ..result
                }))
            }
            Answer::Stream(id) => {
                let sent = stream(encoder, id, now, vehicle);
                self.second_battery(id, vehicle);
                sent
            }
            Answer::ServoBattery => Some(encoder.encode(&make::servo_battery_status(vehicle)?)),
            Answer::Version => Some(encoder.encode(&make::autopilot_version(vehicle))),
            // Wraps after 49 days, as the standard's field does.
            Answer::Metadata => Some(encoder.encode(&COMPONENT_METADATA_DATA {
                time_boot_ms: (now / 1000) as u32,
                file_crc: GENERAL_CRC,
                uri: GENERAL_URI.into(),
            })),
            Answer::Mode { index, all } => {
                if all && usize::from(index) < Mode::ALL.len() {
                    self.services.answer(Answer::Mode {
                        index: index + 1,
                        all,
                    });
                }
                Some(self.encoder.encode(&make::available_mode(index)?))
            }
        }
    }

    fn send_text(&mut self, vehicle: &Vehicle, notice: &'static str) -> Option<u32> {
        // Without budget the text waits; it is made from the state at the time of sending.
        if !self.budget.allows(frame_bytes::<STATUSTEXT_DATA>()) {
            return None;
        }
        let text = self.services.texts.next(vehicle, notice)?;
        Some(self.encoder.encode(&text.message()))
    }

    /// The console and the streams, by turns: each waits for at most one frame of the other.
    fn send_console_by_turns(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        if self.services.shell.waits {
            return self.send_console().or_else(|| self.send_stream(now, vehicle));
        }
        let stream = self.send_stream(now, vehicle);
        self.services.shell.waits = stream.is_some();
        stream.or_else(|| self.send_console())
    }

    fn send_console(&mut self) -> Option<u32> {
        self.services.shell.waits = false;
        if !self.budget.allows(frame_bytes::<SERIAL_CONTROL_DATA>() + RESERVE) {
            return None;
        }
        Some(self.encoder.encode(&self.services.shell.said()?))
    }

    fn send_stream(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        // Each stream at most once: a stream that has lost its turn is not due again.
        for _ in 0..STREAMS.len() {
            let due = self.services.schedule.next(now)?;
            if self.budget.allows(due.bytes + RESERVE) {
                let sent = stream(&mut self.encoder, due.id, now, vehicle);
                if sent.is_some() {
                    self.second_battery(due.id, vehicle);
                    return sent;
                }
            }
        }
        None
    }

    /// If `id` is the flight battery's message, the servo battery's follows, if it is measured.
    fn second_battery(&mut self, id: u32, vehicle: &Vehicle) {
        if id == BATTERY_STATUS_DATA::ID && vehicle.servo_battery.is_some() {
            self.services.answer(Answer::ServoBattery);
        }
    }

    fn send_file(&mut self) -> Option<u32> {
        if !self
            .budget
            .allows(frame_bytes::<FILE_TRANSFER_PROTOCOL_DATA>() + RESERVE)
        {
            return None;
        }
        let (reader, payload) = self.services.ftp.answer()?;
        Some(self.encoder.encode(&FILE_TRANSFER_PROTOCOL_DATA {
            target_network: 0,
            target_system: reader.system,
            target_component: reader.component,
            payload,
        }))
    }

    fn send_listed(&mut self) -> Option<u32> {
        if !self.budget.allows(frame_bytes::<PARAM_VALUE_DATA>() + RESERVE) {
            return None;
        }
        let place = self.services.parameters.listed()?;
        Some(self.encoder.encode(&self.services.parameters.value(place)?))
    }
}

/// Makes the frame of a stream; `None` if the value is stale.
fn stream(encoder: &mut Encoder, id: u32, now: u64, vehicle: &Vehicle) -> Option<u32> {
    // Wraps after 49 days, as the standard's field does.
    let ms = (now / 1000) as u32;
    Some(match id {
        HEARTBEAT_DATA::ID => encoder.encode(&make::heartbeat(vehicle)),
        SYS_STATUS_DATA::ID => encoder.encode(&make::sys_status(vehicle)),
        EXTENDED_SYS_STATE_DATA::ID => encoder.encode(&make::extended_sys_state(vehicle)),
        CURRENT_MODE_DATA::ID => encoder.encode(&make::current_mode(vehicle)),
        ATTITUDE_DATA::ID => encoder.encode(&make::attitude(vehicle, ms)?),
        ATTITUDE_QUATERNION_DATA::ID => encoder.encode(&make::attitude_quaternion(vehicle, ms)?),
        SOPHIE_ARMS_DATA::ID => encoder.encode(&make::arms(vehicle, ms)),
        RC_CHANNELS_DATA::ID => encoder.encode(&make::rc_channels(vehicle, ms)),
        SERVO_OUTPUT_RAW_DATA::ID => encoder.encode(&make::servo_output_raw(vehicle, ms)),
        BATTERY_STATUS_DATA::ID => encoder.encode(&make::battery_status(vehicle)),
        SCALED_PRESSURE_DATA::ID => encoder.encode(&make::scaled_pressure(vehicle, ms)?),
        VIBRATION_DATA::ID => encoder.encode(&make::vibration(vehicle, now)?),
        SCALED_IMU_DATA::ID => encoder.encode(&make::scaled_imu(vehicle, ms)?),
        _ => return None,
    })
}
