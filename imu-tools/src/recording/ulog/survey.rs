//! What a stretch of a log holds of each sensor: which topics, and how many readings of each.

use std::io::Cursor;

use super::channel::Kind;
use super::definitions::Subscription;
use super::messages::{Message, Messages};
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::sensor::Sensor;

/// A topic's instance that holds readings of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Name of the topic.
    pub topic: String,
    /// Which of several of its kind.
    pub instance: u8,
    /// What its readings are.
    pub kind: Kind,
    /// Seen in the stretch that was looked at.
    pub readings: u64,
    /// Number of its chip, as far as it was seen.
    pub device: Option<f64>,
}

impl Candidate {
    /// As `--topic` and lists call it.
    pub fn label(&self) -> String {
        format!("{}:{}", self.topic, self.instance)
    }
}

/// What a stretch of a log holds of each sensor.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// Where angular rates are found, the rawest first.
    pub gyroscope: Vec<Candidate>,
    /// Where specific forces are found, the rawest first.
    pub accelerometer: Vec<Candidate>,
}

impl Survey {
    /// Looks at the bytes that come next, a megabyte at most, without taking them.
    ///
    /// # Errors
    /// When the file cannot be read, or must not be.
    pub fn ahead(messages: &mut Messages) -> Result<Self, Error> {
        let input = messages.input_mut();
        input.fill(LARGEST_PIECE)?;
        let bytes = input.at_hand().to_vec();
        let copy = Input::pipe(input.path(), Box::new(Cursor::new(bytes)));
        let mut copy = Messages::new(copy, messages.definitions.clone());
        let mut survey = Self::of(copy.definitions.subscriptions());
        while let Some(message) = copy.next()? {
            match message {
                Message::Data(place) => {
                    if let Some(subscription) = copy.definitions.at(place) {
                        survey.count(subscription, copy.data());
                    }
                }
                Message::Subscribed(place) => {
                    if let Some(subscription) = copy.definitions.at(place) {
                        survey.add(subscription);
                    }
                }
                Message::Other => {}
            }
        }
        Ok(survey)
    }

    /// Of topics whose data was not looked at.
    pub fn of(subscriptions: &[Subscription]) -> Self {
        let mut survey = Self::default();
        for subscription in subscriptions {
            survey.add(subscription);
        }
        survey
    }

    fn side(&mut self, sensor: Sensor) -> &mut Vec<Candidate> {
        match sensor {
            Sensor::Gyroscope => &mut self.gyroscope,
            Sensor::Accelerometer => &mut self.accelerometer,
        }
    }

    fn add(&mut self, subscription: &Subscription) {
        let Some((kind, layout)) = subscription.readable() else { return };
        let Subscription { topic, instance, .. } = subscription;
        for sensor in Sensor::BOTH {
            let side = self.side(sensor);
            if layout.channel(sensor).is_some()
                && !side.iter().any(|c| c.topic == *topic && c.instance == *instance)
            {
                let (topic, instance) = (topic.clone(), *instance);
                side.push(Candidate { topic, instance, kind, readings: 0, device: None });
                side.sort_by_key(|c| (c.kind, c.instance));
            }
        }
    }

    fn count(&mut self, subscription: &Subscription, message: &[u8]) {
        let Some((_, layout)) = subscription.readable() else { return };
        for sensor in Sensor::BOTH {
            let Some(channel) = layout.channel(sensor) else { continue };
            let mut side = self.side(sensor).iter_mut();
            if let Some(candidate) =
                side.find(|c| c.instance == subscription.instance && c.topic == subscription.topic)
            {
                candidate.readings += channel.count(message);
                candidate.device = candidate.device.or_else(|| channel.device(message));
            }
        }
    }
}
