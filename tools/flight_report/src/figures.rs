//! The figures of the page.

use sophie_sim::record::{FlightRecord, Sample};

use super::figure::{ARM, ARM_NAMES, Figure, arm_legend, arm_series, legend, series};
use super::grip_figure::{closing, grip};
use super::plot::{Panel, Trace, figure};
use super::rotation::to_body;
use super::time_axis::Span;
use sophie_charts::units::deg;

/// All figures, in page order.
pub fn all(record: &FlightRecord) -> Vec<Figure> {
    let span = Span::all(record);
    let mut figures = vec![attitude(record, span), height(record, span)];
    figures.extend(position(record, span));
    figures.extend(below(record, span));
    figures.extend([tilt(record, span), thrust(record, span)]);
    figures.push(grip(record, span, "Tendons and grip", String::new()));
    if let Some((span, note)) = closing(record) {
        figures.push(grip(record, span, "Closing on the pipe", note));
    }
    figures.push(battery(record, span));
    figures
}

fn attitude(record: &FlightRecord, span: Span) -> Figure {
    let axis = |i: usize, name: &str| {
        let pick =
            |f: fn(&Sample) -> &[f64; 3]| series(record, |s| f(s).get(i).map_or(f64::NAN, |v| deg(*v)));
        Panel {
            axis: format!("{name} (deg)"),
            height: 120.0,
            span: 6.0,
            traces: vec![
                Trace {
                    class: "estimate",
                    values: pick(|s| &s.attitude_estimate),
                },
                Trace {
                    class: "true",
                    values: pick(|s| &s.attitude),
                },
                Trace {
                    class: "setpoint",
                    values: pick(|s| &s.attitude_setpoint),
                },
            ],
            ..Panel::default()
        }
    };
    let panels = [axis(0, "roll"), axis(1, "pitch"), axis(2, "yaw")];
    Figure {
        title: "Attitude",
        note: "The setpoint is what the attitude controller aims at, behind the prefilter of the sticks."
            .into(),
        legend: legend(&[
            ("true", "true"),
            ("setpoint", "setpoint"),
            ("estimate", "estimate"),
        ]),
        svg: figure(record, span, "roll, pitch and yaw over time", &panels),
    }
}

fn height(record: &FlightRecord, span: Span) -> Figure {
    let top = record.scenario.world.pipe_top;
    let panel = Panel {
        axis: "height (m)".into(),
        height: 130.0,
        traces: vec![Trace {
            class: "true",
            values: series(record, |s| -s.position[2]),
        }],
        levels: vec![top],
        include: vec![0.0, top],
        ..Panel::default()
    };
    let ground_track = Panel {
        axis: "place (m)".into(),
        height: 110.0,
        span: 1.0,
        traces: vec![
            Trace {
                class: "north",
                values: series(record, |s| s.position[0]),
            },
            Trace {
                class: "east",
                values: series(record, |s| s.position[1]),
            },
        ],
        ..Panel::default()
    };
    Figure {
        title: "Height and place",
        note: "Of the centre of mass, from the take-off point.".into(),
        legend: legend(&[
            ("true", "height"),
            ("level", "top of the pipe"),
            ("north", "north"),
            ("east", "east"),
        ]),
        svg: figure(record, span, "height and place over time", &[panel, ground_track]),
    }
}

/// Position by the poses and by the estimate, if the flight had one.
fn position(record: &FlightRecord, span: Span) -> Option<Figure> {
    record.samples.iter().find(|s| s.position_estimate.is_some())?;
    let axis = |i: usize, name: &str| {
        let of = |place: &Option<[f64; 3]>| place.and_then(|p| p.get(i).copied()).unwrap_or(f64::NAN);
        Panel {
            axis: format!("{name} (m)"),
            height: 100.0,
            span: 0.5,
            traces: vec![
                Trace {
                    class: "setpoint",
                    values: series(record, |s| of(&s.pose)),
                },
                Trace {
                    class: "estimate",
                    values: series(record, |s| of(&s.position_estimate)),
                },
                Trace {
                    class: "true",
                    values: series(record, |s| of(&Some(s.position))),
                },
            ],
            ..Panel::default()
        }
    };
    let panels = [axis(0, "north"), axis(1, "east"), axis(2, "down")];
    let mut kinds = legend(&[("true", "true"), ("estimate", "estimate")]);
    if record.samples.iter().any(|s| s.pose.is_some()) {
        kinds.push(("setpoint", "newest pose, late".into()));
    }
    Some(Figure {
        title: "Position",
        note: "Pose and estimate are in axes of their sender; here they are turned into the true ones."
            .into(),
        legend: kinds,
        svg: figure(record, span, "north, east and down over time", &panels),
    })
}

/// Range and flow of the module below the vehicle, if the vehicle has one.
fn below(record: &FlightRecord, span: Span) -> Option<Figure> {
    let seen = |s: &Sample| s.range_measured.is_some() || s.flow.is_some();
    record.samples.iter().find(|s| seen(s))?;
    let range = Panel {
        axis: "range (m)".into(),
        height: 120.0,
        span: 0.5,
        traces: vec![
            Trace {
                class: "estimate",
                values: series(record, |s| s.range_measured.unwrap_or(f64::NAN)),
            },
            Trace {
                class: "true",
                values: series(record, |s| s.range),
            },
        ],
        include: vec![0.0],
        ..Panel::default()
    };
    let flow = |i: usize, name: &str| Panel {
        axis: format!("{name} (rad/s)"),
        height: 110.0,
        span: 1.0,
        traces: vec![
            Trace {
                class: "estimate",
                values: series(record, |s| {
                    s.flow.and_then(|f| f.get(i).copied()).unwrap_or(f64::NAN)
                }),
            },
            Trace {
                class: "true",
                values: series(record, |s| {
                    true_flow(s).and_then(|f| f.get(i).copied()).unwrap_or(f64::NAN)
                }),
            },
        ],
        ..Panel::default()
    };
    let panels = [range, flow(0, "roll flow"), flow(1, "pitch flow")];
    Some(Figure {
        title: "Range and flow",
        note: "As they come, late. The true flow is that of the point on the body's down axis; over the pipe the lens sees \
               ground beside it too."
            .into(),
        legend: legend(&[("true", "true"), ("estimate", "measured")]),
        svg: figure(record, span, "range and optical flow over time", &panels),
    })
}

/// Least distance of a drawn flow, m: at zero distance it is unbounded.
const NEAREST: f64 = 0.08;

/// Flow of the point that the body's down axis meets, rad/s about the forward and the right axis.
fn true_flow(s: &Sample) -> Option<[f64; 2]> {
    if s.range.is_nan() || s.range < NEAREST {
        return None;
    }
    let [forward, right, _] = to_body(s.attitude, s.velocity);
    Some([s.rate[0] - right / s.range, s.rate[1] + forward / s.range])
}

fn tilt(record: &FlightRecord, span: Span) -> Figure {
    let measured = arm_series(record, |s| &s.tilt_measured, deg);
    let model = arm_series(record, |s| &s.tilt_model, deg);
    let real = arm_series(record, |s| &s.tilt, deg);
    let lines = measured.into_iter().zip(model).zip(real);
    let panels: Vec<Panel<'_>> = lines
        .enumerate()
        .map(|(i, ((measured, model), real))| Panel {
            axis: format!("α{} (deg)", i + 1),
            height: 100.0,
            span: 10.0,
            traces: vec![
                Trace {
                    class: "estimate",
                    values: measured,
                },
                Trace {
                    class: "true",
                    values: real,
                },
                Trace {
                    class: "setpoint",
                    values: model,
                },
            ],
            ..Panel::default()
        })
        .collect();
    Figure {
        title: "Arm tilt",
        note: format!("Positive is tip up. Arms {}.", ARM_NAMES.join(", ")),
        legend: legend(&[
            ("true", "true"),
            ("setpoint", "model in the mixer"),
            ("estimate", "measured by the arm's IMU"),
        ]),
        svg: figure(record, span, "tilt of the four arms over time", &panels),
    }
}

fn thrust(record: &FlightRecord, span: Span) -> Figure {
    let values = arm_series(record, |s| &s.thrust, |v| v);
    let max = f64::from(record.scenario.params.thrust_max);
    let panel = Panel {
        axis: "thrust (N)".into(),
        height: 210.0,
        traces: ARM
            .into_iter()
            .zip(values)
            .map(|(class, values)| Trace { class, values })
            .collect(),
        levels: vec![max],
        include: vec![0.0, max * 1.02],
        marks: saturated(record),
        ..Panel::default()
    };
    let mut legend = arm_legend();
    legend.push(("level", "largest thrust".into()));
    legend.push(("mark", "saturated".into()));
    Figure {
        title: "Rotor thrust",
        note: "True thrust of each rotor.".into(),
        legend,
        svg: figure(record, span, "thrust of the four rotors over time", &[panel]),
    }
}

fn saturated(record: &FlightRecord) -> Vec<(f64, f64)> {
    let mut spans: Vec<(f64, f64)> = vec![];
    for sample in record.samples.iter().filter(|s| s.saturated) {
        match spans.last_mut() {
            Some((_, end)) if sample.t - *end < 0.05 => *end = sample.t,
            _ => spans.push((sample.t, sample.t)),
        }
    }
    spans
}

fn battery(record: &FlightRecord, span: Span) -> Figure {
    let p = &record.scenario.params;
    let volts = series(record, |s| s.battery_voltage);
    let lowest = volts.iter().copied().fold(f64::MAX, f64::min);
    let warning = f64::from(p.battery_warning);
    let near = lowest < warning + 0.6;
    let voltage = Panel {
        axis: "battery (V)".into(),
        height: 120.0,
        span: 1.0,
        traces: vec![Trace {
            class: "true",
            values: volts,
        }],
        levels: near.then_some(warning).into_iter().collect(),
        include: if near { vec![warning] } else { vec![] },
        ..Panel::default()
    };
    let throttle = Panel {
        axis: "throttle (%)".into(),
        height: 100.0,
        traces: vec![Trace {
            class: "north",
            values: series(record, |s| 100.0 * s.throttle),
        }],
        include: vec![0.0, 60.0],
        ..Panel::default()
    };
    let mut legend = legend(&[("true", "battery"), ("north", "throttle")]);
    if near {
        legend.push(("level", "warning".into()));
    }
    Figure {
        title: "Battery and throttle",
        note: "Voltage under load; the pilot's throttle as a share of the largest collective thrust.".into(),
        legend,
        svg: figure(
            record,
            span,
            "battery voltage and throttle over time",
            &[voltage, throttle],
        ),
    }
}
