//! Registers of an SPI part in the InvenSense manner: address byte first, its top bit set for a read, the
//! address advancing by itself in a burst, and on some parts banks behind a select register.

use embedded_hal_async::spi::SpiDevice;

use crate::fault::Fault;

/// Bit of the address byte that makes a transfer a read (DS-000347 §9.6, DS-000143).
const READ: u8 = 0x80;
/// The longest burst that a driver here reads, bytes.
const BURST: usize = 15;

/// What a register is to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Bank, 0 on parts without banks.
    pub bank: u8,
    /// Address in the bank.
    pub register: u8,
    /// The bits that matter; the others keep their value.
    pub mask: u8,
    /// What those bits are to be.
    pub value: u8,
}

impl Setting {
    /// The bits `mask` of a register in `bank` are to be `value`.
    pub const fn bits(bank: u8, register: u8, mask: u8, value: u8) -> Self {
        Self {
            bank,
            register,
            mask,
            value,
        }
    }

    /// A whole register of bank 0 is to be `value`.
    pub const fn all(register: u8, value: u8) -> Self {
        Self::bits(0, register, 0xFF, value)
    }

    /// Compares what was read from the register with what it is to hold.
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

/// The registers of one part.
///
/// All bytes travel through a buffer in this struct, so that it lies where its owner puts it: a board whose
/// DMA cannot reach every memory places the driver, not the stack.
pub struct Registers<S> {
    spi: S,
    bank_select: Option<u8>,
    buffer: [u8; BURST + 1],
}

impl<S: SpiDevice> Registers<S> {
    /// Registers behind `spi`; `bank_select` is the address of the bank select register, if the part has one.
    pub const fn new(spi: S, bank_select: Option<u8>) -> Self {
        Self {
            spi,
            bank_select,
            buffer: [0; BURST + 1],
        }
    }

    /// Reads `N` registers of the selected bank, from `first` upwards, in one transaction.
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

    /// Selects a bank; nothing happens on a part without banks.
    ///
    /// # Errors
    /// [`Fault::Bus`].
    pub async fn select(&mut self, bank: u8) -> Result<(), Fault> {
        match self.bank_select {
            Some(register) => self.write(register, bank).await,
            None => Ok(()),
        }
    }

    /// Writes `settings` in order, keeping the bits outside their masks, and selects bank 0 again.
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

    /// Reads every register of `settings` back and compares; selects bank 0 again if all is well.
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
