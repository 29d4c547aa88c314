//! What a user meets: the `sophie` command, whole flights, and the pages. `scenarios` has a harness of its own, a test a file.

mod campaign;
mod capture;
mod check;
mod check_sweep;
mod cli;
mod determinism;
mod fit_lag;
mod fit_thrust;
mod handbook;
mod live;
mod operator;
mod pages;
mod paper;
mod parameters;
mod recording;
mod study;
mod tuning;
mod unknown;
mod wiring;
mod words;
