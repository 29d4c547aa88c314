//! Assigns functions to parts of the control path.

/// Parts and substrings of their functions' demangled names. The first match counts: a task's poll also names the
/// executor, and a driver's its bus.
const GROUPS: [(&str, &[&str]); 11] = [
    ("laws", &["sophie_control::"]),
    (
        "deadline records",
        &[
            "sophie_tasks::schedule::timing::",
            "sophie_tasks::schedule::histogram::",
            "sophie_tasks::deadline::",
            "TimingRecords>::record",
        ],
    ),
    (
        "frame: encoding, timer",
        &["sophie_drivers::dshot::", "escs::EscTimer"],
    ),
    (
        "sensor's driver",
        &[
            "sophie_drivers::",
            "sophie_boards::stm32::spi::",
            "data_ready::",
            "embassy_stm32::exti::",
            "EXTI",
        ],
    ),
    (
        "tasks, with what is inlined",
        &[
            "TaskStorage<",
            "sophie_tasks::flight::control::",
            "sophie_tasks::flight::mixer::",
            "sophie_tasks::flight::motors::",
        ],
    ),
    (
        "links",
        &[
            "sophie_tasks::links::",
            "sophie_tasks::links::last_value::",
            "embassy_sync::watch::",
            "multi_waker::",
            "embassy_sync::signal::",
        ],
    ),
    ("critical sections", &["CriticalSection", "critical_section"]),
    ("copies", &["memcpy", "memmove", "memset", "memclr"]),
    (
        "DMA, SPI, their interrupts",
        &[
            "embassy_stm32::dma::",
            "embassy_stm32::spi::",
            "DMA1_STREAM",
            "DMA2_STREAM",
            "embassy_futures::join",
        ],
    ),
    (
        "executor, wakers, timers",
        &[
            "embassy_executor::",
            "embassy_time",
            "_embassy_time",
            "atomic_waker",
            "SAI3",
            "CAN1_TX",
            "waker",
        ],
    ),
    (OTHER, &[""]),
];

/// Functions of no other part.
pub const OTHER: &str = "other";

/// Names of all parts, in the table's order.
pub fn names() -> impl Iterator<Item = &'static str> {
    GROUPS.iter().map(|(name, _)| *name)
}

/// Part of a function, by its demangled name.
#[must_use]
pub fn group_of(function: &str) -> &'static str {
    // A generic function belongs to its arguments' part, except for laws, which a task's poll names too.
    let own = |pattern: &&str| function.contains(*pattern);
    let law = |function: &str| {
        let begin = function.trim_start_matches(['<', '&']);
        begin.starts_with("sophie_control::")
    };
    let found = GROUPS.iter().find(|(name, patterns)| match *name {
        "laws" => law(function),
        _ => patterns.iter().any(own),
    });
    found.map_or(OTHER, |(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_grouped_by_their_paths() {
        for (function, group) in [
            ("<sophie_control::allocation::mixer::Mixer>::allocate", "laws"),
            (
                "<embassy_executor::raw::TaskStorage<sophie_flight::tasks::__imu_task::__imu_task_inner_function::{closure#0}>>::poll",
                "tasks, with what is inlined",
            ),
            (
                "<sophie_tasks::schedule::timing::Record>::add",
                "deadline records",
            ),
            (
                "<sophie_tasks::links::link::Link<sophie_control::chain::setpoint::Setpoint>>::latest",
                "links",
            ),
            ("<sophie_tasks::links::last_value::LastValue<u8>>::send", "links"),
            (
                "<sophie_boards::stm32::escs::EscTimer<u8>>::write",
                "frame: encoding, timer",
            ),
            (
                "<sophie_boards::stm32::spi::Selected<u8>>::transfer",
                "sensor's driver",
            ),
            ("sophie_drivers::dshot::fill_bits", "frame: encoding, timer"),
            (
                "<sophie_drivers::spi_imu::SpiImu<sophie_drivers::icm42688p::Config>>::read_raw::{closure#0}",
                "sensor's driver",
            ),
            ("__aeabi_memcpy8", "copies"),
            ("compiler_builtins::mem::memcpy", "copies"),
            (
                "<embassy_stm32::dma::Channel>::configure",
                "DMA, SPI, their interrupts",
            ),
            ("embassy_executor::raw::waker::wake", "executor, wakers, timers"),
            ("__aeabi_ul2f", OTHER),
        ] {
            assert_eq!(group_of(function), group, "{function}");
        }
    }

    #[test]
    fn every_function_has_a_part_that_is_in_the_table() {
        for function in ["", "main", "core::ptr::drop_in_place::<u8>", "TIM2"] {
            assert!(names().any(|name| name == group_of(function)), "{function}");
        }
    }
}
