fn main() -> Result<(), String> {
    use sophie_bench::*;
    use sophie_hil::record::Silent;
    let a: Vec<String> = std::env::args().collect();
    let fw = elf::Firmware::read(std::path::Path::new(&a[1]))?;
    let scenario = sophie_hil::scenario::Scenario::load(std::path::Path::new(&a[2]), &Default::default()).map_err(|e| e.to_string())?;
    let speed = a.get(3).map_or(1.0, |s| s.parse().unwrap());
    let emu = emulator::Emulator::power_on(&fw, emulator::Settings { speed, line: esc::Line::DShot(300) })?;
    let log = log::Log::new(&fw.table);
    let (record, bench) = sophie_hil::flight::fly_with(&scenario, |rng| bench::Bench::new(emu, log, Default::default(), rng, |l| println!("{l}")), &mut Silent);
    println!("{:?} sim {} wall {}", record.outcome, record.sim_seconds, record.wall_seconds);
    for p in &record.phases { println!("{p:?}") }
    for p in &record.grip { println!("{p:?}") }
    let f = bench.finish()?;
    println!("{:#?} {:?} {:?} {:x}", f.run, f.overruns, f.resets, f.log_digest);
    Ok(())
}
