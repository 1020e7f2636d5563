//! A sensor's registers for tests.

use std::collections::BTreeMap;

use super::Bus;

/// Registers at an address, each of some bytes.
pub struct Fake {
    pub registers: BTreeMap<u16, u16>,
    /// What was written, in its order.
    pub written: Vec<(u16, u16)>,
    /// Accesses until it falls silent.
    pub answers: usize,
    /// A register that forgets what is written.
    pub forgets: Option<u16>,
    pub address: u8,
    /// Bytes of a register's number; a value has three less that many.
    pub number_bytes: usize,
}

impl Fake {
    pub fn new(address: u8, number_bytes: usize, registers: &[(u16, u16)]) -> Self {
        let registers = registers.iter().copied().collect();
        Self { registers, written: Vec::new(), answers: usize::MAX, forgets: None, address, number_bytes }
    }

    fn answer(&mut self, address: u8) -> Result<(), ()> {
        if address != self.address {
            return Err(());
        }
        self.answers = self.answers.checked_sub(1).ok_or(())?;
        Ok(())
    }
}

fn number(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |number, &byte| number << 8 | u16::from(byte))
}

impl Bus for Fake {
    type Error = ();

    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), ()> {
        self.answer(address)?;
        let (register, value) = bytes.split_at(self.number_bytes);
        let (register, value) = (number(register), number(value));
        self.written.push((register, value));
        if self.forgets != Some(register) {
            self.registers.insert(register, value);
        }
        Ok(())
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], answer: &mut [u8]) -> Result<(), ()> {
        self.answer(address)?;
        let value = self.registers.get(&number(bytes)).copied().unwrap_or(0).to_be_bytes();
        answer.copy_from_slice(&value[2 - answer.len()..]);
        Ok(())
    }
}
