//! MCAP recordings of ROS: the images of two topics, paired by their time stamps.
//!
//! The file is read once to find where each image is, and again image by image; one chunk of each camera is in
//! memory, never the file.

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Result, anyhow, bail, ensure};

use super::pairing;
use super::views::View;
use super::{Layout, RecordedFrame, Source};
use crate::StereoPair;
use crate::input::caveat::{self, Caveat};
use crate::input::frame::Shrink;
use file::{McapFile, Place};
use image_message::ImageKind;
use topics::Topic;

mod channels;
mod file;
mod image_message;
mod topics;

/// Chunks that are kept: the views of one moment may lie in two.
const KEPT: usize = 2;

/// The moments of an MCAP file.
#[derive(Debug)]
pub(super) struct McapRecording {
    file: McapFile,
    /// The two topics, with the kind of their messages.
    cameras: [(String, ImageKind); 2],
    moments: Vec<[Option<Place>; 2]>,
    chunks: Mutex<VecDeque<Chunk>>,
}

/// The messages of a chunk, or why they cannot be had.
#[derive(Debug)]
struct Chunk {
    at: u64,
    messages: Result<HashMap<usize, Vec<u8>>, String>,
}

/// The frames of the MCAP file in `path`; the patterns of `layout` tell the topics.
///
/// # Errors
/// If it cannot be read, if nothing tells which topics are the cameras', or which messages belong together.
pub(super) fn find_frames(path: &Path, layout: &Layout) -> Result<Vec<RecordedFrame>> {
    let name = path.display();
    let wanted = match layout {
        Layout::Separate => None,
        Layout::Patterns { left, right } => Some([left.as_str(), right.as_str()]),
        _ => bail!("{name}: is an MCAP file, where --left TOPIC and --right TOPIC tell the cameras, not --layout"),
    };
    let file = McapFile::open(path)?;
    let (found, is_whole) = topics::find(&file).map_err(|error| anyhow!("{name}: {error:#}"))?;
    let topics = topics::choose(&found, wanted).map_err(|error| anyhow!("{name}: {error:#}"))?;
    let times = times(topics).map_err(|error| anyhow!("{name}: {error:#}"))?;
    let [left, right] = [0, 1].map(|side| times[side].iter().map(|&time| view(time)).collect());
    let pairs = pairing::pair(left, right).map_err(|error| anyhow!("{name}: {error:#}"))?;
    if !is_whole {
        caveat::tell(Caveat::CutOff, &name);
    }
    let place = |side: usize| -> HashMap<i128, Place> {
        times[side].iter().zip(&topics[side].images).map(|(&time, image)| (time, image.place)).collect()
    };
    let places = [place(0), place(1)];
    let find = |side: usize, view: &Option<View>| places[side].get(&view.as_ref()?.moment?).copied();
    let moments = pairs.iter().map(|pair| [find(0, &pair.left), find(1, &pair.right)]).collect();
    let cameras = topics.map(|topic| (topic.name.clone(), topic.kind));
    let recording = Arc::new(McapRecording { file, cameras, moments, chunks: Mutex::default() });
    let frames = pairs.into_iter().enumerate().filter_map(|(index, pair)| {
        let name = pair.left.or(pair.right)?.name;
        Some(RecordedFrame::new(index, name, Source::Mcap(Arc::clone(&recording), index)))
    });
    Ok(frames.collect())
}

/// The time of each image: that in its header, or that of its recording where the headers' do not tell them apart.
fn times(topics: [&Topic; 2]) -> Result<[Vec<i128>; 2]> {
    let all = |time: fn(&topics::Image) -> i128| topics.map(|topic| topic.images.iter().map(time).collect::<Vec<_>>());
    let is_distinct = |times: &[Vec<i128>; 2]| {
        times.iter().all(|times| {
            let mut times = times.clone();
            times.sort_unstable();
            times.windows(2).all(|pair| pair[0] != pair[1])
        })
    };
    let (stamps, logged) = (all(|image| image.stamp), all(|image| image.logged));
    ensure!(
        is_distinct(&stamps) || is_distinct(&logged),
        "several images of one topic have the same time, so nothing tells which belong together"
    );
    Ok(if is_distinct(&stamps) { stamps } else { logged })
}

fn view(time: i128) -> View {
    let name = time.to_string();
    View { path: PathBuf::from(&name), key: name.clone(), moment: Some(time), name }
}

impl McapRecording {
    pub(super) fn path(&self) -> &Path {
        self.file.path()
    }

    /// Reads both views of a moment.
    pub(super) fn read(&self, moment: usize, shrink: Shrink) -> Result<StereoPair> {
        let [left, right] = [0, 1].map(|side| -> Result<_> {
            let (topic, kind) = &self.cameras[side];
            let told = || format!("{}: {topic}", self.path().display());
            let Some(place) = self.moments[moment][side] else {
                bail!("{}: has no image of that moment", told());
            };
            let message = self.message(place).map_err(|error| anyhow!("{}: {error:#}", told()))?;
            kind.decode(&message).map_err(|error| anyhow!("{}: {error:#}", told()))
        });
        StereoPair::of_images([left?, right?], [self.path(); 2], shrink)
    }

    /// The data of a message.
    fn message(&self, place: Place) -> Result<Vec<u8>> {
        let mut chunks = self.chunks.lock().unwrap_or_else(PoisonError::into_inner);
        if !chunks.iter().any(|chunk| chunk.at == place.record) {
            let messages = self.messages(place.record).map_err(|error| format!("{error:#}"));
            chunks.truncate(KEPT - 1);
            chunks.push_front(Chunk { at: place.record, messages });
        }
        let chunk = chunks.iter().find(|chunk| chunk.at == place.record);
        let found = chunk.map(|chunk| chunk.messages.as_ref().map(|messages| messages.get(&place.message)));
        match found {
            Some(Ok(Some(message))) => Ok(message.clone()),
            Some(Err(error)) => bail!("{error}"),
            _ => bail!("its message is gone, was the file changed?"),
        }
    }

    /// All messages with images of the chunk that begins there.
    fn messages(&self, at: u64) -> Result<HashMap<usize, Vec<u8>>> {
        let places = self.moments.iter().flatten().flatten();
        let wanted: HashSet<usize> = places.filter(|place| place.record == at).map(|place| place.message).collect();
        let mut found = HashMap::new();
        self.file.visit_messages(at, |index, data| {
            if wanted.contains(&index) {
                found.insert(index, data.into_owned());
            }
        })?;
        Ok(found)
    }
}
