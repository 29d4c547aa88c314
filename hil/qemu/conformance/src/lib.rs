//! Shared code of the images for a processor under test.

#![no_std]

pub mod fold;
