//! Bytes of a port to samples: which protocol it is, its messages, their times.
//!
//! The first bytes are kept until they show the protocol, and are then read as if they came now. Bytes
//! of which hardly any is part of a message end the session with a sentence: a wrong baud rate, or a
//! protocol that is none of ours. Where samples came before, that is told of, and the session goes on.

use super::clock::{Clock, Source};
use super::link::{Link, LinkClock};
use super::protocol::{Decoder, Protocol, candidate, candidates, recognise};
use super::rates::rates;
use super::run::{Decode, Step};
use super::stretch::{Amiss, Stretch};
use super::{Kind, Message, shown};
use crate::error::Error;
use crate::recording::{Block, ReadOptions, SampleKind, Temperature};

/// Bytes that are tried for a protocol now and then, and by which it must have shown.
const TRIED: usize = 512;
const ENOUGH: usize = 8192;

/// From bytes to samples.
pub struct Intake {
    name: String,
    options: ReadOptions,
    state: State,
    clock: Clock,
    stretch: Stretch,
    /// When the latest bytes came.
    latest_ns: i64,
}

enum State {
    /// Nobody knows the protocol yet: what came, and when.
    Unknown { first: Vec<u8>, pieces: Vec<(i64, usize)>, tried: usize },
    /// It is known.
    Known(Decoder),
}

/// The protocol that is named by a user who tells what columns hold: those are of text.
#[must_use]
pub fn named(protocol: Option<Protocol>, options: &ReadOptions) -> Option<Protocol> {
    let columns = options.columns.is_some() || options.map.is_some();
    protocol.or(columns.then_some(Protocol::Text))
}

/// The part of some bytes that `protocol` (or where none is named, any) does not explain; `None` where they
/// are too few to say.
#[must_use]
pub fn refused(protocol: Option<Protocol>, options: &ReadOptions, bytes: &[u8]) -> Option<f64> {
    /// Fewer say nothing.
    const FEWEST: usize = 64;
    if bytes.len() < FEWEST {
        return None;
    }
    let best = match protocol {
        Some(protocol) => candidate(protocol, options, bytes),
        None if recognise(bytes).is_some() => return Some(0.0),
        None => candidates(bytes).first().copied(),
    };
    Some(1.0 - best.map_or(0.0, |best| best.accepted))
}

impl Intake {
    /// Of a port of this name, by `protocol` or that which the bytes show. Of `options`, those for tables
    /// tell what lines of text hold.
    ///
    /// # Errors
    /// When the options are none for such lines, or for this protocol.
    pub fn new(
        name: &str,
        protocol: Option<Protocol>,
        options: &ReadOptions,
    ) -> Result<Self, Error> {
        let state = match named(protocol, options) {
            Some(protocol) => State::Known(decoder(protocol, options)?),
            None => State::Unknown { first: Vec::new(), pieces: Vec::new(), tried: 0 },
        };
        Ok(Self {
            name: name.to_owned(),
            options: options.clone(),
            state,
            clock: Clock::default(),
            stretch: Stretch::default(),
            latest_ns: 0,
        })
    }

    /// Looks which protocol the first bytes speak, and reads them then.
    fn look(&mut self, at_end: bool, to: &mut Vec<Step>) -> Result<(), Error> {
        let State::Unknown { first, pieces, tried } = &mut self.state else { return Ok(()) };
        if first.len() < *tried + TRIED && !at_end {
            return Ok(());
        }
        *tried = first.len();
        let Some(protocol) = recognise(first) else {
            if first.len() < ENOUGH && !at_end {
                return Ok(());
            }
            return Err(unknown(&self.name, first));
        };
        let mut decoder = decoder(protocol, &self.options)?;
        let (first, pieces) = (std::mem::take(first), std::mem::take(pieces));
        let mut rest = first.as_slice();
        for (arrival_ns, length) in pieces {
            let (piece, later) = rest.split_at(length.min(rest.len()));
            decode(&mut decoder, &mut self.clock, arrival_ns, piece, to);
            rest = later;
        }
        self.state = State::Known(decoder);
        Ok(())
    }

    /// Takes what the decoder waits with: nothing that comes belongs to it.
    fn end(&mut self, pieces: &mut Pieces<'_>) {
        let Self { state: State::Known(decoder), clock, latest_ns, .. } = self else { return };
        decoder.end(&mut |message| {
            clock.take(*latest_ns, &message, |message, taken| pieces.take(message, &taken));
        });
    }
}

impl Decode for Intake {
    fn feed(&mut self, arrival_ns: i64, bytes: &[u8], to: &mut Vec<Step>) -> Result<(), Error> {
        if bytes.is_empty() {
            return Ok(());
        }
        self.latest_ns = arrival_ns;
        match &mut self.state {
            State::Unknown { first, pieces, .. } => {
                first.extend_from_slice(bytes);
                pieces.push((arrival_ns, bytes.len()));
                self.look(false, to)
            }
            State::Known(decoder) => {
                decode(decoder, &mut self.clock, arrival_ns, bytes, to);
                self.stretch.look(decoder.tally());
                let (name, protocol) = (&self.name, decoder.protocol());
                match self.stretch.amiss().filter(|_| self.stretch.is_hopeless()) {
                    Some(Amiss::Refused(share)) => Err(Error::data(format!(
                        "{:.0} % of the bytes of {name} are no {protocol}: the baud rate is wrong (see \
                         --baud), or the protocol is (see --protocol); the latest bytes are {}",
                        100.0 * share,
                        shown::bytes(bytes)
                    ))),
                    Some(Amiss::Fruitless(bytes)) => Err(fruitless(name, protocol, bytes)),
                    None => Ok(()),
                }
            }
        }
    }

    fn reopened(&mut self, to: &mut Vec<Step>) {
        let mut pieces = Pieces::new(to);
        self.end(&mut pieces);
        self.clock.reopened(|message, taken| pieces.take(message, &taken));
        pieces.close();
    }

    fn finish(&mut self, to: &mut Vec<Step>) -> Result<(), Error> {
        self.look(true, to)?;
        let mut pieces = Pieces::new(to);
        self.end(&mut pieces);
        self.clock.finish(|message, taken| pieces.take(message, &taken));
        pieces.close();
        Ok(())
    }

    fn tell(&self, link: &mut Link) {
        let State::Known(decoder) = &self.state else {
            if let State::Unknown { first, .. } = &self.state {
                link.bytes = first.len() as u64;
            }
            return;
        };
        let tally = decoder.tally();
        link.protocol = Some(decoder.protocol().name());
        link.learnt = decoder.learnt().map(str::to_owned);
        (link.bytes, link.refused) = (tally.bytes, tally.refused);
        (link.bad_checksums, link.messages) = (tally.damaged, tally.messages);
        // What ends the session is told by that.
        let amiss = self.stretch.amiss().filter(|_| !self.stretch.is_hopeless());
        link.amiss = amiss.map(|amiss| {
            let protocol = decoder.protocol();
            match amiss {
                Amiss::Refused(_) => format!(
                    "hardly any byte is {protocol} any more: has the sensor another baud rate now?"
                ),
                Amiss::Fruitless(_) if self.stretch.had_samples() => format!(
                    "{protocol} comes, and in it no sample any more: what is it set to send?"
                ),
                Amiss::Fruitless(_) => {
                    format!("{protocol} comes, and in it no sample yet: {}", way_out(protocol))
                }
            }
        });
        let status = self.clock.status();
        link.clock = (status.rate_hz > 0.0).then_some(LinkClock {
            by_arrival: status.source == Source::Arrival,
            rate_hz: status.rate_hz,
            rate_sd_hz: status.rate_sd_hz,
            jitter_s: status.jitter_s,
            lost: status.lost,
            lost_is_certain: status.lost_is_certain,
            restarts: status.restarts,
        });
    }
}

/// A decoder; options that it has no use for are refused.
fn decoder(protocol: Protocol, options: &ReadOptions) -> Result<Decoder, Error> {
    let given = [
        ("--columns", options.columns.is_some()),
        ("--map", options.map.is_some()),
        ("--gyro-unit", options.gyro_unit.is_some()),
        ("--accel-unit", options.accel_unit.is_some()),
        ("--time-unit", options.time_unit.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given && protocol != Protocol::Text) {
        Some((option, _)) => Err(Error::usage(format!(
            "{option} is for lines of text, and {protocol} tells that itself: leave it out"
        ))),
        None => Decoder::new(protocol, options),
    }
}

/// Whole frames, none of a sensor.
fn fruitless(name: &str, protocol: Protocol, bytes: u64) -> Error {
    Error::data(format!(
        "{name} sends {protocol}, and none of {bytes} bytes tells what a sensor measured: {}",
        way_out(protocol)
    ))
}

/// What to do about that.
fn way_out(protocol: Protocol) -> &'static str {
    match protocol {
        Protocol::Text => "say what the columns are, such as --columns t,gx,gy,gz,ax,ay,az",
        _ => "set the device to send its angular rates and accelerations",
    }
}

/// What no protocol explains.
fn unknown(name: &str, bytes: &[u8]) -> Error {
    if bytes.is_empty() {
        return Error::data(format!("not a byte came of {name}: see that something is sent to it"));
    }
    let share = candidates(bytes).first().map_or(0.0, |best| best.accepted);
    Error::data(format!(
        "what {name} sends is of no known protocol ({:.0} % of the bytes are refused): the baud rate may be \
         wrong (see --baud), or --protocol or --columns are wanted; the first bytes are {}",
        100.0 * (1.0 - share),
        shown::bytes(bytes)
    ))
}

/// Takes bytes through decoder and clock.
fn decode(
    decoder: &mut Decoder,
    clock: &mut Clock,
    arrival_ns: i64,
    bytes: &[u8],
    to: &mut Vec<Step>,
) {
    let mut pieces = Pieces::new(to);
    decoder.feed(bytes, &mut |message| {
        clock.take(arrival_ns, &message, |message, taken| pieces.take(message, &taken));
    });
    pieces.close();
}

/// Puts samples into blocks, with restarts between.
struct Pieces<'a> {
    block: Block,
    /// What its samples are.
    samples: SampleKind,
    to: &'a mut Vec<Step>,
}

impl<'a> Pieces<'a> {
    fn new(to: &'a mut Vec<Step>) -> Self {
        Self { block: Block::default(), samples: SampleKind::default(), to }
    }

    fn take(&mut self, message: &Message, taken: &super::clock::Taken) {
        if taken.restart {
            self.close();
            self.to.push(Step::Restart);
        }
        // `rates` divides increments by their time.
        let samples = match message.kind {
            Kind::Rates => SampleKind::Instantaneous,
            Kind::Increments { .. } => SampleKind::Mean,
        };
        if samples != self.samples {
            self.close();
            self.samples = samples;
        }
        let (gyroscope, accelerometer) = rates(message, taken);
        self.block.gyroscope.extend(gyroscope);
        self.block.accelerometer.extend(accelerometer);
        let stamp_ns = taken.stamp_ns;
        self.block
            .temperature
            .extend(message.celsius.map(|celsius| Temperature { stamp_ns, celsius }));
    }

    fn close(&mut self) {
        if !self.block.is_empty() {
            self.to.push(Step::Samples(std::mem::take(&mut self.block), self.samples));
        }
    }
}

#[cfg(test)]
#[path = "intake_tests.rs"]
mod tests;
