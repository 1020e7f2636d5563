//! What the messages of a recording are: its schemas and channels, of which any record may be damaged.

use std::collections::HashMap;

use mcap::records::Record;

use super::image_message::ImageKind;

/// What several records tell of one number. Those that a checksum guards overrule the others.
#[derive(Debug)]
struct Told<T>(HashMap<u16, Option<(T, bool)>>);

impl<T: PartialEq> Told<T> {
    /// Whether that changes what was told before. Where two contradict each other, neither is believed.
    fn add(&mut self, id: u16, value: T, is_checked: bool) -> bool {
        let new = Some((value, is_checked));
        match self.0.get_mut(&id) {
            None => {
                self.0.insert(id, new);
                false
            }
            Some(Some((old, was_checked))) if Some(&*old) == new.as_ref().map(|(value, _)| value) => {
                *was_checked |= is_checked;
                false
            }
            Some(Some((_, true))) => false,
            Some(told) => {
                *told = new.filter(|_| is_checked);
                true
            }
        }
    }

    fn get(&self, id: u16) -> Option<&T> {
        self.0.get(&id)?.as_ref().map(|(value, _)| value)
    }
}

#[derive(Debug, PartialEq)]
struct Channel {
    schema: u16,
    topic: String,
    encoding: String,
}

/// The schemas and channels that were told so far.
#[derive(Debug)]
pub(super) struct Channels {
    schemas: Told<String>,
    channels: Told<Channel>,
}

impl Channels {
    pub(super) fn new() -> Self {
        Self { schemas: Told(HashMap::new()), channels: Told(HashMap::new()) }
    }

    /// Notes a schema or channel; `is_checked`: a checksum guards it. Whether that changes what was told before.
    pub(super) fn add(&mut self, record: Record<'_>, is_checked: bool) -> bool {
        match record {
            Record::Schema { header, .. } => self.schemas.add(header.id, header.name, is_checked),
            Record::Channel(channel) => {
                let id = channel.id;
                let channel =
                    Channel { schema: channel.schema_id, topic: channel.topic, encoding: channel.message_encoding };
                self.channels.add(id, channel, is_checked)
            }
            _ => false,
        }
    }

    /// Topic and kind of a channel's messages, if they are images.
    pub(super) fn images_of(&self, channel: u16) -> Option<(&str, ImageKind)> {
        let Channel { schema, topic, encoding } = self.channels.get(channel)?;
        let schema = self.schemas.get(*schema).map_or("", String::as_str);
        Some((topic, ImageKind::of(schema, encoding)?))
    }

    /// Types of all messages.
    pub(super) fn types(&self) -> Vec<String> {
        let told = self.schemas.0.iter().filter_map(|(id, told)| Some((id, told.as_ref()?)));
        let mut types: Vec<(&u16, &String)> = told.map(|(id, (name, _))| (id, name)).collect();
        types.sort_unstable();
        types.into_iter().map(|(_, name)| name.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_checked_holds_and_of_two_that_are_not_neither() {
        let mut told = Told(HashMap::new());
        assert!(!told.add(1, "left", false) && !told.add(1, "left", false));
        assert!(told.add(1, "right", true), "overruled");
        assert!(!told.add(1, "left", false) && !told.add(1, "front", true), "the first checked one holds");
        assert_eq!(told.get(1), Some(&"right"));
        told.add(2, "left", false);
        assert!(told.add(2, "lift", false));
        assert_eq!(told.get(2), None);
        assert!(told.add(2, "left", true));
        assert_eq!(told.get(2), Some(&"left"));
    }
}
