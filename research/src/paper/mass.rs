//! Table II: mass budget and derived rigid-body numbers.

use sophie_control::params::Params;
use sophie_sim::plant::GRAVITY;
use sophie_sim::plant::hinged::link::TIP_MASS;

use super::printed::Printed;
use crate::results::model::{Class, Comparison, Section, Table, num};

/// Places of the masses, m (assumed; the paper gives no dimension): platform with battery and electronics as a box
/// (length, width, height), servos and reels sideways.
const BOX: [f64; 3] = [0.40, 0.12, 0.06];
const BATTERY_LENGTH: f64 = 0.15;
const SERVO_SIDE: f64 = 0.05;

/// Roll, pitch, yaw, kg·m², from Table II: arms as rods from the centre line to the rotor, propulsion as points at
/// their ends.
pub fn inertia(p: &Printed, d: f64, b: f64) -> [f64; 3] {
    let m = |name: &str| {
        let row = p.table_2.iter().find(|r| r.equipment == name);
        row.map_or(0.0, |r| r.mass_g * 1e-3 * f64::from(r.count))
    };
    let (arms, motors, servos) = (m("Arms"), m("Propulsion"), m("Other mechanisms"));
    let (platform, inside) = (m("Platform"), m("Battery") + m("Electronics"));
    let [l, w, h] = BOX.map(|x| x * x);
    let y2 = motors * d * d + arms * d * d / 3.0 + servos * SERVO_SIDE * SERVO_SIDE + platform * w / 12.0;
    let x2 =
        (motors + arms + servos) * b * b + (platform * l + inside * BATTERY_LENGTH * BATTERY_LENGTH) / 12.0;
    let z2 = platform * h / 12.0;
    [y2 + z2, x2 + z2, x2 + y2]
}

/// Table II.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("table2", "Table II: the mass budget");
    let mass = p.mass();
    let hover = mass * GRAVITY / 4.0;
    let nominal = nominal_thrust(p);
    s.finding = format!(
        "The rows add up to {mass:.3} kg, hover takes {hover:.3} N a rotor. The nominal thrust of {:.0} g a motor is \
         {:.3} of that: the four motors at their nominal thrust just carry the vehicle, so the 25° roll needs their largest.",
        p.text.motor_thrust_g,
        nominal / hover
    );
    s.compare(
        "Table II",
        vec![Comparison {
            what: "total mass".to_owned(),
            unit: "kg",
            printed: p.text.total_mass_kg,
            here: mass,
            class: Class::Prediction,
            why: "sum of the six rows".to_owned(),
        }],
    );
    s.table(shares(p));
    s.table(rigid_body(p));
    let tip = tip_mass(p);
    s.text(format!(
        "The tip is the one that does not fit: Table II puts {tip:.3} kg on a hinge at the centre line, the plant flies \
         {TIP_MASS} kg so that the bending mode is at 5 Hz. The paper gives neither a frequency nor where the arm bends; \
         with the whole {tip:.3} kg the mode would be at {:.1} Hz.",
        5.0 * (TIP_MASS / tip).sqrt()
    ));
    let [a, b] = p.text.weight_saving_percent;
    s.text(format!(
        "\"Reduced by {a:.0} % and {b:.0} %\" against the two rigid vehicles means that those weigh {:.2} and {:.2} kg; the \
         paper does not print their masses.",
        mass / (1.0 - 0.01 * a),
        mass / (1.0 - 0.01 * b)
    ));
    s
}

fn nominal_thrust(p: &Printed) -> f64 {
    p.text.motor_thrust_g * 1e-3 * GRAVITY
}

/// kg: propulsion and a third of the arm.
fn tip_mass(p: &Printed) -> f64 {
    let arm_rod = p.table_2.first().map_or(0.0, |r| r.mass_g * 1e-3) / 3.0;
    let propulsion = p.table_2.iter().find(|r| r.equipment == "Propulsion");
    propulsion.map_or(0.0, |r| r.mass_g * 1e-3) + arm_rod
}

fn shares(p: &Printed) -> Table {
    let mut t = Table::new("Shares of the mass", &["equipment", "mass kg", "share %"]);
    for row in &p.table_2 {
        let kg = row.mass_g * 1e-3 * f64::from(row.count);
        t.row([
            row.equipment.as_str().into(),
            num(kg, 3),
            num(100.0 * kg / p.mass(), 1),
        ]);
    }
    t
}

fn rigid_body(p: &Printed) -> Table {
    let d = Params::default();
    let weight = p.mass() * GRAVITY;
    let hover = weight / 4.0;
    let computed = inertia(p, f64::from(d.arm_d), f64::from(d.arm_b));
    let mut t = Table::new(
        "Rigid-body numbers",
        &["quantity", "value", "unit", "used in flight", "source"],
    );
    let flown = [d.inertia_roll, d.inertia_pitch, d.inertia_yaw];
    for (axis, (i, f)) in ["roll", "pitch", "yaw"].iter().zip(computed.iter().zip(flown)) {
        t.row([
            format!("inertia, {axis}").into(),
            num(*i, 4),
            "kg m²".into(),
            num(f64::from(f), 3),
            "Table II on an assumed layout; ±30 %".into(),
        ]);
    }
    for (what, value, unit, used, source) in [
        ("weight", weight, "N", weight, "Table II"),
        ("hover thrust of a rotor", hover, "N", hover, "Table II"),
        (
            "largest thrust of all over weight",
            f64::from(d.thrust_max) * 4.0 / weight,
            "",
            f64::NAN,
            "8.3 N a rotor, assumed",
        ),
        (
            "nominal thrust of all over weight",
            nominal_thrust(p) / hover,
            "",
            f64::NAN,
            "450 g printed, Table II",
        ),
        (
            "mass carried by an arm's tip",
            tip_mass(p),
            "kg",
            TIP_MASS,
            "propulsion and a third of the arm, Table II",
        ),
    ] {
        t.row([
            what.into(),
            num(value, 3),
            unit.into(),
            num(used, 3),
            source.into(),
        ]);
    }
    t
}
