//! dev
use sophie_hil::record::*;
use sophie_hil::scenario::Scenario;
struct P;
impl Observer for P {
    fn step_began(&mut self, t: f64, i: usize, n: usize, name: &str) { println!("{t:7.2} begin {i}/{n} {name}"); }
    fn step_ended(&mut self, t: f64, p: &Phase) { println!("{t:7.2} end {} {:.1} s err {:.1} tilt {:.1} sat {:.2} V {:.2}", p.name, p.end-p.start, p.worst_attitude_error.to_degrees(), p.worst_tilt.to_degrees(), p.saturation, p.battery_voltage); }
    fn progress(&mut self, _: f64, _: sophie_control::mode::Mode, _: f64) {}
    fn event(&mut self, e: &Event) { println!("{:7.2}   {}", e.t, e.text); }
}
fn main() {
    let mut s = Scenario::default_mission();
    if let Some(seed) = std::env::args().nth(1) { s.seed = seed.parse().unwrap(); }
    if let Ok(v) = std::env::var("RHO") { s.vehicle.infill = v.parse().unwrap(); s.params.infill = s.vehicle.infill as f32; }
    if std::env::var("TWO").is_ok() { s.arms = sophie_control::rc::ArmChoice::Front; }
    if let Ok(v) = std::env::var("EYE") { s.pilot.eye_noise = v.parse().unwrap(); }
    if let Ok(v) = std::env::var("GUST") { s.world.gust_force = v.parse().unwrap(); }
    let r = sophie_hil::flight::fly(&s, &mut P);
    println!("{:?} {:?} sim {} wall {} ratio {} overruns {} digest {:x}", r.outcome, r.grip, r.sim_seconds, r.wall_seconds, r.sim_seconds/r.wall_seconds, r.overruns, r.digest);
    if std::env::var("S").is_ok() {
        let from: f64 = std::env::var("S").unwrap().parse().unwrap();
        for x in r.samples.iter().filter(|x| x.t > from).step_by(10) {
            println!("{:.2} {:?} pos {:.2?} att {:.1?} tilt {:.1?} thr {:.2?} ten {:.1?} asked {:.1?} p {:.0?} pm {:.0?} throttle {:.2}", x.t, x.mode, x.position, x.attitude.map(f64::to_degrees), x.tilt.map(f64::to_degrees), x.thrust, x.tension, x.tension_asked, x.pressure, x.pressure_measured, x.throttle);
        }
    }
}
