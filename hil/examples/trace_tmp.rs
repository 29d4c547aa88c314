use sophie_hil::{flight::fly, record::Silent, scenario::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = Scenario::load(std::path::Path::new(&a[1]), &Overrides::default()).unwrap();
    let r = fly(&s, &mut Silent);
    for e in &r.events {
        println!("{:.2} {}", e.t, e.text);
    }
    println!("{:?}", r.outcome);
    let (t0, t1): (f64, f64) = (a[2].parse().unwrap(), a[3].parse().unwrap());
    let n: usize = a[4].parse().unwrap();
    for (i, x) in r.samples.iter().enumerate() {
        if x.t >= t0 && x.t <= t1 && i % n == 0 {
            println!(
                "{:.2} {:?} p {:.0?} ten {:.1?} asked {:.1?} tilt {:.2?} thr {:.1?} z {:.2} y{:.2} roll{:.2}",
                x.t,
                x.mode,
                x.pressure,
                x.tension,
                x.tension_asked,
                x.tilt,
                x.thrust,
                x.position[2],
                x.position[1],
                x.attitude[0]
            );
        }
    }
}
