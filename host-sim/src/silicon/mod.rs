//! The methods on a bare board: pairs sent to its program `bench` over a serial port, every row compared with the host's.

pub mod client;
pub mod instructions;
pub mod port;
pub mod run;
pub mod table;
