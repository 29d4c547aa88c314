//! What the images for a processor under test share: numbers that are the same everywhere.

#![no_std]

pub mod fold;
