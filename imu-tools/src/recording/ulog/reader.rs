//! Reading a log front to back, in a file or a pipe.

use super::MAGIC;
use super::channel::{LONGEST_BATCH, Taken};
use super::choice::Choice;
use super::definitions::{Definitions, Subscription};
use super::messages::{Message, Messages};
use super::survey::Survey;
use crate::error::Error;
use crate::recording::input::{Input, LARGEST_PIECE};
use crate::recording::sensor::Sensor;
use crate::recording::{
    BLOCK_SAMPLES, Block, ForceUnit, Note, RateUnit, ReadOptions, Sample, Source, Stream,
    Temperature,
};

/// Bytes before the first message: [`MAGIC`], version, time of the start.
const FILE_HEADER: usize = 16;

/// A log being read.
pub struct UlogReader {
    messages: Messages,
    choice: Choice,
    /// What is wanted of each topic, by its place.
    roles: Vec<Role>,
    gyroscope: Tally,
    accelerometer: Tally,
    /// Factors to SI units: 1 unless the user says that the log does not keep to them.
    rate: f64,
    force: f64,
    ended: bool,
    notes: Vec<Note>,
}

/// What is wanted of a topic's messages.
#[derive(Clone, Copy, Debug, Default)]
struct Role {
    gyroscope: bool,
    accelerometer: bool,
    temperature: bool,
}

/// Messages taken of a sensor.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    messages: u64,
    malformed: u64,
    clipped: u64,
}

impl Tally {
    fn add(&mut self, taken: Taken) {
        self.messages += 1;
        self.malformed += u64::from(taken.malformed);
        self.clipped += u64::from(taken.clipped);
    }
}

impl UlogReader {
    /// Starts to read: finds the topics, as far ahead as is needed for that.
    ///
    /// # Errors
    /// When this is no ULog, or has no topic that fits, or several.
    pub fn open(mut input: Input, options: &ReadOptions) -> Result<Self, Error> {
        if options.are_for_a_table() || options.bag_time {
            return Err(Error::usage(format!(
                "{} is a ULog: --columns, --map and --time-unit are for tables, --bag-time is for bags",
                input.path().display()
            )));
        }
        let choice = Choice::new(options.topic.as_deref(), options.survey)?;
        let whole = input.fill(FILE_HEADER)?;
        if !input.at_hand().starts_with(MAGIC) {
            return Err(Error::data(format!("{} is no ULog", input.path().display())));
        }
        if !whole {
            return Err(Error::data(format!(
                "{} is cut off in its first 16 bytes: nothing of the log is left",
                input.path().display()
            )));
        }
        input.consume(FILE_HEADER);
        let mut reader = Self {
            messages: Messages::new(input, Definitions::default()),
            choice,
            roles: Vec::new(),
            gyroscope: Tally::default(),
            accelerometer: Tally::default(),
            rate: options.gyro_unit.map_or(1.0, RateUnit::to_rad_s),
            force: options.accel_unit.map_or(1.0, ForceUnit::to_m_s2),
            ended: false,
            notes: Vec::new(),
        };
        reader.find()?;
        Ok(reader)
    }

    /// Chooses the topics by what stretches of the log hold, up to the first that has one.
    fn find(&mut self) -> Result<(), Error> {
        loop {
            let survey = Survey::ahead(&mut self.messages)?;
            let stretch = self.messages.input().at_hand().len();
            let end = self.messages.input().offset() + stretch as u64;
            self.choose(&survey)?;
            let last = stretch < LARGEST_PIECE;
            if self.choice.enough() || (self.choice.any() && !last) {
                return Ok(());
            }
            while last || self.messages.input().offset() < end {
                match self.messages.next()? {
                    Some(Message::Subscribed(_)) => self.roles.push(Role::default()),
                    Some(_) => {}
                    None => return Err(self.not_found()),
                }
            }
        }
    }

    fn choose(&mut self, survey: &Survey) -> Result<(), Error> {
        self.choice.choose(survey, self.messages.input().path())?;
        self.notes.append(&mut self.choice.notes);
        let all = self.messages.definitions.subscriptions();
        self.roles = all.iter().map(|subscription| role(&self.choice, subscription)).collect();
        Ok(())
    }

    fn not_found(&self) -> Error {
        self.choice.not_found(&self.messages.definitions, self.messages.input().path())
    }

    /// Takes one message; `false` at the end.
    #[inline]
    fn step(&mut self, to: &mut Block) -> Result<bool, Error> {
        match self.messages.next()? {
            Some(Message::Data(place)) => self.take(place, to),
            Some(Message::Subscribed(place)) => self.subscribed(place)?,
            Some(Message::Other) => {}
            None => return Ok(false),
        }
        Ok(true)
    }

    /// Takes what is wanted of the data at hand.
    #[inline]
    fn take(&mut self, place: usize, to: &mut Block) {
        let Some(&role) = self.roles.get(place) else { return };
        if !role.gyroscope && !role.accelerometer && !role.temperature {
            return;
        }
        let subscription = self.messages.definitions.at(place);
        let Some((_, layout)) = subscription.and_then(Subscription::readable) else { return };
        let message = self.messages.data();
        let stamp_ns = layout.stamp_ns(message);
        let sides = [
            (role.gyroscope, &layout.gyroscope, &mut self.gyroscope, &mut to.gyroscope),
            (
                role.accelerometer,
                &layout.accelerometer,
                &mut self.accelerometer,
                &mut to.accelerometer,
            ),
        ];
        for (wanted, channel, tally, samples) in sides {
            if let (true, Some(channel)) = (wanted, channel) {
                let malformed = Taken { malformed: true, clipped: false };
                tally.add(stamp_ns.map_or(malformed, |at| channel.take(message, at, samples)));
            }
        }
        if let (true, Some(field), Some(stamp_ns)) =
            (role.temperature, layout.temperature, stamp_ns)
            && let Some(celsius) = field.read(message).filter(|celsius| celsius.is_finite())
        {
            to.temperature.push(Temperature { stamp_ns, celsius });
        }
    }

    /// Gives a topic that turns up its role; it may be the one that was missing.
    #[cold]
    fn subscribed(&mut self, place: usize) -> Result<(), Error> {
        let Some(subscription) = self.messages.definitions.at(place) else { return Ok(()) };
        if self.choice.complete() {
            self.roles.push(role(&self.choice, subscription));
            return Ok(());
        }
        let survey = Survey::of(std::slice::from_ref(subscription));
        self.choose(&survey)
    }

    /// Puts into words, once, what was strange.
    fn warn(&mut self) {
        let path = self.messages.input().path();
        self.notes.append(&mut self.messages.remarks.warnings(path));
        let path = path.display();
        let mut warn = |what: String| self.notes.push(Note::Warning(what));
        for (sensor, label, tally) in [
            (Sensor::Gyroscope, &self.choice.gyroscope, &self.gyroscope),
            (Sensor::Accelerometer, &self.choice.accelerometer, &self.accelerometer),
        ] {
            let Tally { messages, malformed, clipped } = tally;
            if label.is_empty() {
                let sensor = sensor.name();
                warn(format!("{path} has no readings of the {sensor}: there is no topic with any"));
            }
            if *malformed > 0 {
                warn(format!(
                    "{malformed} of {messages} messages of {label} in {path} make no sense: they \
                     are passed over"
                ));
            }
            if *clipped > 0 {
                warn(format!(
                    "{clipped} of {messages} messages of {label} in {path} were clipped: the \
                     motion exceeded the sensor's range"
                ));
            }
        }
    }
}

/// What is wanted of a topic.
fn role(choice: &Choice, subscription: &Subscription) -> Role {
    let label = subscription.label();
    Role {
        gyroscope: label == choice.gyroscope,
        accelerometer: label == choice.accelerometer,
        temperature: label == choice.thermometer,
    }
}

/// Brings values to SI units.
fn scale(samples: &mut [Sample], factor: f64) {
    if factor != 1.0 {
        for value in samples.iter_mut().flat_map(|sample| &mut sample.value) {
            *value *= factor;
        }
    }
}

/// Whether another message fits, be it a whole FIFO.
#[inline]
fn has_room(block: &Block) -> bool {
    let longest = block.gyroscope.len().max(block.accelerometer.len());
    longest.max(block.temperature.len()) <= BLOCK_SAMPLES - LONGEST_BATCH
}

impl Source for UlogReader {
    fn next_block(&mut self, block: &mut Block) -> Result<bool, Error> {
        block.clear();
        while !self.ended && has_room(block) {
            if !self.step(block)? {
                self.ended = true;
                if !self.choice.enough() {
                    return Err(self.not_found());
                }
                self.warn();
            }
        }
        scale(&mut block.gyroscope, self.rate);
        scale(&mut block.accelerometer, self.force);
        Ok(!block.is_empty())
    }

    fn streams(&self) -> Vec<Stream> {
        let mut streams: Vec<Stream> = Vec::new();
        let all = self.messages.definitions.subscriptions();
        for subscription in all {
            let (name, messages) = (subscription.label(), subscription.messages);
            if let Some(stream) = streams.iter_mut().find(|stream| stream.name == name) {
                stream.messages += messages;
                continue;
            }
            let role = role(&self.choice, subscription);
            streams.push(Stream {
                used: role.gyroscope || role.accelerometer || role.temperature,
                type_name: subscription.topic.clone(),
                name,
                messages,
            });
        }
        streams
    }

    fn gyroscope(&self) -> &str {
        &self.choice.gyroscope
    }

    fn accelerometer(&self) -> &str {
        &self.choice.accelerometer
    }

    fn take_notes(&mut self) -> Vec<Note> {
        std::mem::take(&mut self.notes)
    }

    fn bytes_read(&self) -> u64 {
        self.messages.input().offset()
    }

    fn bytes_total(&self) -> Option<u64> {
        self.messages.input().len()
    }
}
