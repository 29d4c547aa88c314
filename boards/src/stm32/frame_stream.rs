//! The DMA stream of a motor frame. The HAL sets it up once, which takes 150 instructions; each later frame writes
//! three registers: flags, length, enable.
//!
//! The clock times the end of a frame, not the stream's interrupt. The stream still has rows of zeros to move then, so
//! that no timer request is left over to shift the next frame a bit early.

use core::sync::atomic::{Ordering, fence};

use embassy_stm32::dma::Transfer;
use embassy_stm32::pac::dma::regs::{Cr, Ixr, Ndtr};
use embassy_stm32::pac::dma::{Dma, St};
use embassy_stm32::{pac, peripherals};

/// Polls of a disabled stream, which finishes its beat: a few bus cycles.
const LOOKS: u32 = 100;

/// Location of a stream's registers.
pub trait FrameStream {
    /// DMA controller.
    const CONTROLLER: Dma;
    /// Stream number, 0 to 7.
    const NUMBER: usize;
}

macro_rules! streams {
    ($($controller:ident: $($stream:ident $number:literal)+;)+) => {
        $($(impl FrameStream for peripherals::$stream {
            const CONTROLLER: Dma = pac::$controller;
            const NUMBER: usize = $number;
        })+)+
    };
}

streams! {
    DMA1: DMA1_CH0 0 DMA1_CH1 1 DMA1_CH2 2 DMA1_CH3 3 DMA1_CH4 4 DMA1_CH5 5 DMA1_CH6 6 DMA1_CH7 7;
    DMA2: DMA2_CH0 0 DMA2_CH1 1 DMA2_CH2 2 DMA2_CH3 3 DMA2_CH4 4 DMA2_CH5 5 DMA2_CH6 6 DMA2_CH7 7;
}

/// A stream from one memory to one register.
pub struct Stream {
    controller: Dma,
    registers: St,
    /// Index of the flag register, and the stream's flags in it.
    flags: (usize, Ixr),
    /// Configuration by the HAL, disabled and without interrupts.
    control: Cr,
    length: Ndtr,
}

impl Stream {
    /// Stream `D` as `first` set it up for `length` values, stopped.
    pub fn of<D: FrameStream>(first: Transfer<'_>, length: usize) -> Self {
        let registers = D::CONTROLLER.st(D::NUMBER);
        let mut control = registers.cr().read();
        // Dropping it keeps address, length and FIFO (embassy-stm32 0.6, `Channel::request_reset`).
        drop(first);
        control.set_en(false);
        control.set_teie(false);
        control.set_htie(false);
        control.set_tcie(false);
        let [low, high] = [D::NUMBER % 4 / 2 * 16, D::NUMBER % 2 * 6];
        Self {
            controller: D::CONTROLLER,
            registers,
            flags: (D::NUMBER / 4, Ixr(0b11_1101 << (low + high))),
            control,
            length: Ndtr(length as u32),
        }
    }

    /// Ends a transfer, finished or not.
    #[inline]
    pub fn stop(&self) {
        let control = self.registers.cr();
        if control.read().en() {
            control.write_value(self.control);
            for _ in 0..LOOKS {
                if !control.read().en() {
                    break;
                }
            }
        }
    }

    /// Makes the stream wait for requests. It fetches the first values at once.
    #[inline]
    pub fn arm(&self) {
        let (register, flags) = self.flags;
        // A stream cannot be enabled while one of its flags is set (RM0433 §16.3.19, RM0090 §10.3.18).
        self.controller.ifcr(register).write_value(flags);
        self.registers.ndtr().write_value(self.length);
        // Earlier writes reach memory before the stream fetches them.
        fence(Ordering::SeqCst);
        let mut control = self.control;
        control.set_en(true);
        self.registers.cr().write_value(control);
    }
}
