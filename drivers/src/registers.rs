//! Registers of an InvenSense SPI part: address byte with a read bit, address increment in bursts, on some parts banks
//! behind a select register.

use embedded_hal_async::spi::SpiDevice;

use crate::fault::Fault;

/// Read bit of the address byte (DS-000347 §9.6, DS-000143).
const READ: u8 = 0x80;
const BURST: usize = 15;

/// A required register value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Bank, 0 on parts without banks.
    pub bank: u8,
    /// Address in the bank.
    pub register: u8,
    /// Relevant bits; others stay.
    pub mask: u8,
    /// Value of those bits.
    pub value: u8,
}

impl Setting {
    /// Requires `value` in the bits `mask` of a register in `bank`.
    pub const fn bits(bank: u8, register: u8, mask: u8, value: u8) -> Self {
        Self {
            bank,
            register,
            mask,
            value,
        }
    }

    /// Requires `value` of a whole register in bank 0.
    pub const fn all(register: u8, value: u8) -> Self {
        Self::bits(0, register, 0xFF, value)
    }

    /// Compares a value read with the required one.
    ///
    /// # Errors
    /// [`Fault::Configuration`] where they differ.
    pub const fn compare(&self, read: u8) -> Result<(), Fault> {
        let (expected, found) = (self.value & self.mask, read & self.mask);
        if expected == found {
            Ok(())
        } else {
            Err(Fault::Configuration {
                bank: self.bank,
                register: self.register,
                expected,
                found,
            })
        }
    }
}

/// Registers of one part. Transfers use a buffer in this struct: where DMA does not reach every memory, the board
/// places the driver.
pub struct Registers<S> {
    spi: S,
    bank_select: Option<u8>,
    buffer: [u8; BURST + 1],
}

impl<S: SpiDevice> Registers<S> {
    /// Registers on `spi`, with a bank select register or none.
    pub const fn new(spi: S, bank_select: Option<u8>) -> Self {
        Self {
            spi,
            bank_select,
            buffer: [0; BURST + 1],
        }
    }

    /// Reads `N` registers of the selected bank from `first`.
    ///
    /// # Errors
    /// [`Fault::Bus`].
    pub async fn read<const N: usize>(&mut self, first: u8) -> Result<[u8; N], Fault> {
        const { assert!(N <= BURST, "the burst is longer than the buffer") };
        self.buffer.fill(0);
        if let Some(address) = self.buffer.first_mut() {
            *address = first | READ;
        }
        let Some(transfer) = self.buffer.get_mut(..=N) else {
            return Err(Fault::Bus);
        };
        self.spi
            .transfer_in_place(transfer)
            .await
            .map_err(|_| Fault::Bus)?;
        transfer.last_chunk::<N>().copied().ok_or(Fault::Bus)
    }

    /// Writes one register of the selected bank.
    ///
    /// # Errors
    /// [`Fault::Bus`].
    pub async fn write(&mut self, register: u8, value: u8) -> Result<(), Fault> {
        let Some(transfer) = self.buffer.first_chunk_mut::<2>() else {
            return Err(Fault::Bus);
        };
        *transfer = [register & !READ, value];
        self.spi.transfer_in_place(transfer).await.map_err(|_| Fault::Bus)
    }

    /// Selects a bank; no effect on a part without banks.
    ///
    /// # Errors
    /// [`Fault::Bus`].
    pub async fn select(&mut self, bank: u8) -> Result<(), Fault> {
        match self.bank_select {
            Some(register) => self.write(register, bank).await,
            None => Ok(()),
        }
    }

    /// Writes `settings` in order, keeping the bits outside their masks, and selects bank 0.
    ///
    /// # Errors
    /// [`Fault::Bus`].
    pub async fn apply(&mut self, settings: &[Setting]) -> Result<(), Fault> {
        let mut selected = None;
        for setting in settings {
            self.follow(setting.bank, &mut selected).await?;
            let old = if setting.mask == 0xFF {
                [0]
            } else {
                self.read(setting.register).await?
            };
            let [old] = old;
            self.write(
                setting.register,
                (old & !setting.mask) | (setting.value & setting.mask),
            )
            .await?;
        }
        self.follow(0, &mut selected).await
    }

    /// Reads back and compares `settings`; selects bank 0 if they match.
    ///
    /// # Errors
    /// [`Fault::Configuration`] for the first register that differs, [`Fault::Bus`].
    pub async fn verify(&mut self, settings: &[Setting]) -> Result<(), Fault> {
        let mut selected = None;
        for setting in settings {
            self.follow(setting.bank, &mut selected).await?;
            let [read] = self.read(setting.register).await?;
            setting.compare(read)?;
        }
        self.follow(0, &mut selected).await
    }

    async fn follow(&mut self, bank: u8, selected: &mut Option<u8>) -> Result<(), Fault> {
        if *selected != Some(bank) {
            self.select(bank).await?;
            *selected = Some(bank);
        }
        Ok(())
    }
}
