//! What tasks, links and drivers do together, on fakes or in whole flights.

mod clamp_bench;
mod console;
mod flight_faults;
mod flight_level;
mod flight_step;
mod grip_faults;
mod hardware_faults;
mod imu_rates;
mod judge;
mod links;
mod maths;
mod misfit;
mod motor_map;
mod motor_pulses;
mod parts;
mod pressure_loads;
mod radio;
mod reasons;
mod receiver;
mod response;
mod restart;
mod sbus;
mod servo_battery;
mod silence;
mod strong_vehicles;
mod vehicle;
