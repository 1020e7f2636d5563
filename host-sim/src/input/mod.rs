//! What comes in: images, recordings of them, dumps of a camera port, row packets, rig descriptions.

pub mod caveat;
pub mod frame;
pub mod image_file;
pub mod noise;
pub mod packet_stream;
pub mod raw_dump;
pub mod raw_stream;
pub mod recording;
pub mod rig_file;
pub mod whole_file;
