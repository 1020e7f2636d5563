//! The topics of a recording that have images, and which two of them are the cameras.

use std::collections::BTreeMap;

use anyhow::{Result, bail, ensure};
use mcap::records::Record;

use super::channels::Channels;
use super::file::{McapFile, Place, Trust};
use super::image_message::ImageKind;
use crate::input::recording::Side;
use crate::input::recording::names::Scheme;

/// The most images that a recording may have: a week of 15 Hz.
const MAX_IMAGES: usize = 10_000_000;

/// A topic with images.
#[derive(Debug)]
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) kind: ImageKind,
    pub(super) images: Vec<Image>,
}

/// An image that was not decoded yet.
#[derive(Debug)]
pub(super) struct Image {
    pub(super) place: Place,
    /// Nanoseconds in the message's header.
    pub(super) stamp: i128,
    /// Nanoseconds when it was recorded.
    pub(super) logged: i128,
}

/// What a recording has.
#[derive(Debug, Default)]
pub(super) struct Topics {
    images: BTreeMap<String, Topic>,
    /// Types of all messages.
    types: Vec<String>,
}

/// Finds the topics with images; whether the file is whole.
pub(super) fn find(file: &McapFile) -> Result<(Topics, bool)> {
    let mut channels = Channels::new();
    let (topics, is_whole, is_sure) = find_with(file, &mut channels)?;
    // Where something is damaged, messages may have come before what they are was known for certain.
    Ok(if is_whole && is_sure { (topics, true) } else { (find_with(file, &mut channels)?.0, false) })
}

/// The same by the schemas and channels that are known, and those that come to them; whether none of them changed.
fn find_with(file: &McapFile, channels: &mut Channels) -> Result<(Topics, bool, bool)> {
    let (mut images, mut count, mut is_sure) = (BTreeMap::<String, Topic>::new(), 0, true);
    let is_whole = file.visit(|place, trust, content| {
        match content {
            Record::Message { header, data } => {
                let Some((name, kind)) = channels.images_of(header.channel_id) else { return Ok(()) };
                let logged = i128::from(header.log_time);
                // What cannot be read is a damaged frame of that moment.
                let stamp = kind.stamp(&data).unwrap_or(logged);
                let new = || Topic { name: name.to_owned(), kind, images: Vec::new() };
                let topic = images.entry(name.to_owned()).or_insert_with(new);
                topic.images.push(Image { place, stamp, logged });
                count += 1;
                ensure!(count <= MAX_IMAGES, "has more than {MAX_IMAGES} images, too many for a recording");
            }
            _ if trust == Trust::Damaged => {}
            told => is_sure &= !channels.add(told, trust == Trust::Checked),
        }
        Ok(())
    })?;
    Ok((Topics { images, types: channels.types() }, is_whole, is_sure))
}

/// The topics of the left and the right camera: those that `wanted` tells, or the only two whose names do.
pub(super) fn choose<'a>(topics: &'a Topics, wanted: Option<[&str; 2]>) -> Result<[&'a Topic; 2]> {
    let images = &topics.images;
    let list = || images.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
    ensure!(
        !images.is_empty(),
        "has no image of sensor_msgs/Image or CompressedImage in it{}",
        if topics.types.is_empty() { String::new() } else { format!(", but {}", shortened(&topics.types)) }
    );
    if let Some([left, right]) = wanted {
        let pair = [one("--left", left, images)?, one("--right", right, images)?];
        ensure!(pair[0].name != pair[1].name, "--left and --right: are the same topic {}", pair[0].name);
        return Ok(pair);
    }
    let pairs = pairs(images);
    match &pairs[..] {
        [pair] => Ok(*pair),
        [] => bail!(
            "no two of its topics with images are called left and right, cam0 and cam1 or the like; --left TOPIC and \
             --right TOPIC tell which: {}",
            list()
        ),
        several => {
            let told = several.iter().map(|[left, right]| format!("--left {} --right {}", left.name, right.name));
            bail!("has images of more than two cameras, tell which: {}", told.collect::<Vec<_>>().join(", or "))
        }
    }
}

fn shortened(types: &[String]) -> String {
    const SHOWN: usize = 6;
    let more = if types.len() > SHOWN { " and more" } else { "" };
    types.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ") + more
}

/// The only topic that a pattern matches.
fn one<'a>(option: &str, pattern: &str, images: &'a BTreeMap<String, Topic>) -> Result<&'a Topic> {
    let glob = glob::Pattern::new(pattern).map_err(|error| anyhow::anyhow!("{option} {pattern}: {error}"))?;
    let matches = |name: &str| glob.matches(name) || name.strip_prefix('/').is_some_and(|name| glob.matches(name));
    let found: Vec<&Topic> = images.values().filter(|topic| matches(&topic.name)).collect();
    let names = |topics: &[&Topic]| topics.iter().map(|topic| topic.name.clone()).collect::<Vec<_>>().join(", ");
    match &found[..] {
        [topic] => Ok(topic),
        [] => bail!(
            "{option} {pattern}: matches no topic with images; there are {}",
            names(&images.values().collect::<Vec<_>>())
        ),
        several => bail!("{option} {pattern}: matches several topics: {}", names(several)),
    }
}

/// Topics whose names differ in the camera only.
fn pairs(images: &BTreeMap<String, Topic>) -> Vec<[&Topic; 2]> {
    for scheme in Scheme::ALL {
        let mut found = BTreeMap::<String, [Option<&Topic>; 2]>::new();
        for topic in images.values() {
            // RealSense's left and right imagers.
            let name = topic.name.replace("infra1", "cam0").replace("infra2", "cam1");
            if let Some((side, key)) = scheme.split(&name) {
                found.entry(key).or_default()[usize::from(side == Side::Right)] = Some(topic);
            }
        }
        let pairs: Vec<[&Topic; 2]> = found.into_values().filter_map(|[left, right]| Some([left?, right?])).collect();
        if !pairs.is_empty() {
            return pairs;
        }
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topics(names: &[&str]) -> Topics {
        let kind = ImageKind::of("sensor_msgs/msg/Image", "cdr").unwrap();
        let topic = |name: &&str| ((*name).to_owned(), Topic { name: (*name).to_owned(), kind, images: Vec::new() });
        Topics { images: names.iter().map(topic).collect(), types: Vec::new() }
    }

    #[test]
    fn the_cameras_are_those_that_the_names_tell() {
        let cases: [(&[&str], [&str; 2]); 6] = [
            (&["/right/image_raw", "/left/image_raw"], ["/left/image_raw", "/right/image_raw"]),
            (&["/cam0/image_raw", "/cam1/image_raw"], ["/cam0/image_raw", "/cam1/image_raw"]),
            (&["/stereo/left_image", "/stereo/right_image", "/rgb"], ["/stereo/left_image", "/stereo/right_image"]),
            (
                &["/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw", "/camera/color/image_raw"],
                ["/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"],
            ),
            (&["/image_0", "/image_1"], ["", ""]),
            (&["/zed/left/image_rect", "/zed/right/image_rect"], ["/zed/left/image_rect", "/zed/right/image_rect"]),
        ];
        for (names, wanted) in cases {
            let topics = topics(names);
            match choose(&topics, None) {
                Ok(pair) => assert_eq!(pair.map(|topic| topic.name.as_str()), wanted),
                Err(error) => assert_eq!(wanted, ["", ""], "{error}"),
            }
        }
    }

    #[test]
    fn what_nothing_tells_is_refused_with_what_would() {
        let two = ["/left/image_raw", "/right/image_raw", "/left/image_rect", "/right/image_rect"];
        let told = choose(&topics(&two), None).unwrap_err().to_string();
        assert!(told.contains("--left /left/image_rect --right /right/image_rect"), "{told}");
        let told = choose(&topics(&["/front", "/back"]), None).unwrap_err().to_string();
        assert!(told.contains("/back, /front"), "{told}");
        let all = topics(&["/front", "/back", "/bottom"]);
        assert_eq!(
            choose(&all, Some(["/front", "ba*"])).unwrap().map(|topic| topic.name.as_str()),
            ["/front", "/back"]
        );
        for wanted in [["/front", "/b*"], ["/front", "/top"], ["/front", "front"], ["/front", "["]] {
            assert!(choose(&all, Some(wanted)).is_err(), "{wanted:?}");
        }
    }
}
