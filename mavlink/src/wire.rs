//! The line itself: frames out of bytes, signatures, the protocol in use, the requests in a frame, the byte budget.

pub mod budget;
pub mod frame;
pub mod parser;
pub mod protocol_detector;
pub mod requests;
pub mod signing;
