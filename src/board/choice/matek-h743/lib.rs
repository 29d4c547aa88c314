//! Nothing: that it is there is all that counts.
#![no_std]
