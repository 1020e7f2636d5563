//! The application between the camera and the serial ports. It knows no chip and no board.

pub mod address_ring;
#[cfg(target_os = "none")]
pub mod alive;
#[cfg(target_os = "none")]
pub mod autopilot;
#[cfg(target_os = "none")]
pub mod capture;
pub mod edge;
#[cfg(target_os = "none")]
pub mod lookout;
#[cfg(target_os = "none")]
pub mod measuring;
pub mod phase;
pub mod port;
#[cfg(target_os = "none")]
pub mod results;
#[cfg(target_os = "none")]
pub mod ring;
#[cfg(target_os = "none")]
pub mod settings;
pub mod shown;
#[cfg(target_os = "none")]
pub mod statistics;
#[cfg(target_os = "none")]
pub mod vision;
