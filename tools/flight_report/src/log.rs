//! `flight.mcap`: every sample, for Foxglove and PlotJuggler.
//!
//! Times are simulated nanoseconds from power-up. Frames are Foxglove's: `world` is north, west, up from take-off,
//! `vehicle` forward, left, up.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use serde_json::{Value, json};
use sophie_sim::record::{FlightRecord, Sample};

use super::time_stamp::{nanoseconds, stamp};
use super::{scene, schemas};
use sophie_charts::units::deg;
use sophie_charts::units::tidy;

/// Hz; samples have their full rate.
const SCENE_HZ: f64 = 20.0;

/// The file's content.
///
/// # Errors
/// If the writer fails.
pub fn mcap(record: &FlightRecord) -> Result<Vec<u8>, String> {
    write(record).map_err(|error| format!("flight.mcap: cannot be made: {error}"))
}

fn write(record: &FlightRecord) -> mcap::McapResult<Vec<u8>> {
    let library = concat!("sophie ", env!("CARGO_PKG_VERSION"));
    let options = WriteOptions::new().compression(None).library(library);
    let mut file = File {
        writer: options.create(Cursor::new(Vec::new()))?,
        sequence: 0,
    };
    let truth = file.channel("/truth", "sophie.Truth", &schemas::own(schemas::TRUTH))?;
    let stack = file.channel("/stack", "sophie.Stack", &schemas::own(schemas::STACK))?;
    let sensed =
        |s: &&Sample| s.pose.is_some() || s.range_measured.is_some() || s.position_estimate.is_some();
    let position = match record.samples.iter().find(sensed) {
        Some(_) => Some(file.channel("/position", "sophie.Position", &schemas::own(schemas::POSITION))?),
        None => None,
    };
    let events = file.channel("/events", "foxglove.Log", &schemas::log())?;
    let frames = file.channel("/tf", "foxglove.FrameTransform", &schemas::frame_transform())?;
    let drawing = file.channel("/scene", "foxglove.SceneUpdate", &schemas::scene_update())?;

    file.message(drawing, 0.0, &scene::fixed(record))?;
    let (mut next_scene, mut next_event) = (0.0, 0);
    for sample in &record.samples {
        while let Some(event) = record.events.get(next_event).filter(|e| e.t <= sample.t) {
            file.message(events, event.t, &log_message(event.t, &event.text))?;
            next_event += 1;
        }
        file.message(truth, sample.t, &truth_message(sample))?;
        file.message(stack, sample.t, &stack_message(sample))?;
        if let Some(position) = position {
            file.message(position, sample.t, &position_message(sample))?;
        }
        file.message(frames, sample.t, &scene::transform(sample))?;
        if sample.t >= next_scene {
            file.message(drawing, sample.t, &scene::vehicle(sample))?;
            next_scene = sample.t + 1.0 / SCENE_HZ - 1e-6;
        }
    }
    for event in record.events.iter().skip(next_event) {
        file.message(events, event.t, &log_message(event.t, &event.text))?;
    }
    file.writer.finish()?;
    Ok(file.writer.into_inner().into_inner())
}

struct File {
    writer: mcap::Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

impl File {
    fn channel(&mut self, topic: &str, name: &str, schema: &Value) -> mcap::McapResult<u16> {
        let schema = self
            .writer
            .add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
        self.writer.add_channel(schema, topic, "json", &BTreeMap::new())
    }

    fn message(&mut self, channel_id: u16, t: f64, message: &Value) -> mcap::McapResult<()> {
        let log_time = nanoseconds(t);
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time,
            publish_time: log_time,
        };
        self.writer
            .write_to_known_channel(&header, message.to_string().as_bytes())
    }
}

fn log_message(t: f64, text: &str) -> Value {
    const INFO: u8 = 2;
    json!({ "timestamp": stamp(t), "level": INFO, "message": text, "name": "sophie", "file": "", "line": 0 })
}

fn tidied<const N: usize>(values: &[f64; N], unit: impl Fn(f64) -> f64) -> Vec<f64> {
    values.iter().map(|v| tidy(unit(*v))).collect()
}

fn si(value: f64) -> f64 {
    value
}

fn truth_message(s: &Sample) -> Value {
    json!({
        "position": tidied(&s.position, si),
        "velocity": tidied(&s.velocity, si),
        "attitude_deg": tidied(&s.attitude, deg),
        "rate": tidied(&s.rate, si),
        "tilt_deg": tidied(&s.tilt, deg),
        "thrust": tidied(&s.thrust, si),
        "tension": tidied(&s.tension, si),
        "pressure": tidied(&s.pressure, si),
        "battery_voltage": tidy(s.battery_voltage),
    })
}

fn stack_message(s: &Sample) -> Value {
    json!({
        "mode": s.mode.name(),
        "attitude_estimate_deg": tidied(&s.attitude_estimate, deg),
        "attitude_setpoint_deg": tidied(&s.attitude_setpoint, deg),
        "tilt_measured_deg": tidied(&s.tilt_measured, deg),
        "tilt_model_deg": tidied(&s.tilt_model, deg),
        "thrust_asked": tidied(&s.thrust_asked, si),
        "tension_asked": tidied(&s.tension_asked, si),
        "pressure_measured": tidied(&s.pressure_measured, si),
        "throttle": tidy(s.throttle),
        "saturated": s.saturated,
    })
}

fn position_message(s: &Sample) -> Value {
    let place = |place: Option<[f64; 3]>| tidied(&place.unwrap_or([f64::NAN; 3]), si);
    json!({
        "estimate": place(s.position_estimate),
        "pose": place(s.pose),
        "range_true": tidy(s.range),
        "range": tidy(s.range_measured.unwrap_or(f64::NAN)),
        "flow": tidied(&s.flow.unwrap_or([f64::NAN; 2]), si),
    })
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    fn messages(record: &FlightRecord) -> Vec<(String, String, u64, Value)> {
        let bytes = mcap(record).unwrap();
        mcap::MessageStream::new(&bytes)
            .unwrap()
            .map(|message| {
                let m = message.unwrap();
                let schema = m.channel.schema.as_ref().unwrap();
                assert_eq!(
                    (schema.encoding.as_str(), m.channel.message_encoding.as_str()),
                    ("jsonschema", "json")
                );
                assert!(serde_json::from_slice::<Value>(&schema.data).unwrap()["properties"].is_object());
                let content = serde_json::from_slice(&m.data).unwrap();
                (m.channel.topic.clone(), schema.name.clone(), m.log_time, content)
            })
            .collect()
    }

    #[test]
    fn the_log_reads_back_with_all_channels() {
        let record = synthetic::record();
        let all = messages(&record);
        let count = |topic: &str, schema: &str| all.iter().filter(|m| m.0 == topic && m.1 == schema).count();
        assert_eq!(count("/truth", "sophie.Truth"), record.samples.len());
        assert_eq!(count("/stack", "sophie.Stack"), record.samples.len());
        assert_eq!(count("/tf", "foxglove.FrameTransform"), record.samples.len());
        assert_eq!(count("/events", "foxglove.Log"), record.events.len());
        assert!(count("/scene", "foxglove.SceneUpdate") > record.samples.len() / 6);
        assert!(all.windows(2).all(|w| w[0].2 <= w[1].2), "in order of time");
    }

    #[test]
    fn messages_hold_what_their_schema_says_at_the_sample_s_time() {
        let record = synthetic::record();
        let all = messages(&record);
        let (i, sample) = (1234, &record.samples[1234]);
        for (topic, fields) in [("/truth", schemas::TRUTH), ("/stack", schemas::STACK)] {
            let (_, _, time, content) = all.iter().filter(|m| m.0 == topic).nth(i).unwrap();
            assert_eq!(*time, (sample.t * 1e9).round() as u64);
            let object = content.as_object().unwrap();
            assert_eq!(object.len(), fields.len());
            for (name, field, _) in fields {
                let value = &object[*name];
                match field {
                    schemas::Field::Number => assert!(value.is_number(), "{name}"),
                    schemas::Field::Two => assert_eq!(value.as_array().unwrap().len(), 2, "{name}"),
                    schemas::Field::Three => assert_eq!(value.as_array().unwrap().len(), 3, "{name}"),
                    schemas::Field::Arms => assert_eq!(value.as_array().unwrap().len(), 4, "{name}"),
                    schemas::Field::Word => assert!(value.is_string(), "{name}"),
                    schemas::Field::Flag => assert!(value.is_boolean(), "{name}"),
                }
            }
        }
        let (_, _, _, tf) = all.iter().filter(|m| m.0 == "/tf").nth(i).unwrap();
        assert_eq!(tf["translation"]["z"], tidy(-sample.position[2]));
        let first = all.iter().find(|m| m.0 == "/stack").unwrap();
        for missing in ["attitude_setpoint_deg", "pressure_measured"] {
            assert!(first.3[missing][0].is_null(), "{missing}: null, not a number");
        }
    }

    #[test]
    fn a_flight_without_samples_still_makes_a_log() {
        let mut record = synthetic::record();
        record.samples.clear();
        assert_eq!(
            messages(&record).iter().filter(|m| m.0 == "/events").count(),
            record.events.len()
        );
    }
}
