//! Parts of an emulated microcontroller that the boards share.

pub(crate) mod chip;
pub(crate) mod clock_stretch;
pub(crate) mod count;
pub(crate) mod edge_probe;
pub(crate) mod ignore_dma;
pub(crate) mod pads;
pub(crate) mod rtt;
pub(crate) mod serial;
pub(crate) mod usb;
