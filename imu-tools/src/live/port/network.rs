//! A network connection: a serial server, or a program that forwards bytes. Opened again when it closes.

use std::io;
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use socket2::{SockRef, TcpKeepalive};

use super::Arrival;
use super::again::{self, Again};
use crate::error::Error;

/// How long to wait for an answer, and between attempts.
const PATIENCE: Duration = Duration::from_secs(5);
const PAUSE: Duration = Duration::from_millis(500);

/// A peer that is silent for so long is asked, so often, whether it is still there: one that lost power says
/// nothing, and with the third question unanswered it is gone.
const ASKED_AFTER: Duration = Duration::from_secs(10);
const ASKED_EVERY: Duration = Duration::from_secs(5);
const ASKED: u32 = 3;

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::from(io::ErrorKind::NotFound);
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_read_timeout(Some(PAUSE))?;
                let asked = TcpKeepalive::new().with_time(ASKED_AFTER);
                let asked = asked.with_interval(ASKED_EVERY).with_retries(ASKED);
                SockRef::from(&stream).set_tcp_keepalive(&asked)?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Connects, and begins to read.
pub(super) fn open(address: &str, to: SyncSender<Arrival>) -> Result<(), Error> {
    let first = connect(address).map_err(|e| {
        let why = match e.kind() {
            io::ErrorKind::ConnectionRefused => "nobody listens at that port".to_owned(),
            io::ErrorKind::TimedOut => "there is no answer".to_owned(),
            _ => e.to_string(),
        };
        Error::data(format!("cannot connect to tcp://{address}: {why}; see that the server runs"))
    })?;
    let address = address.to_owned();
    let why = |ended: io::Result<()>| match ended {
        Ok(()) => "the connection was closed".to_owned(),
        Err(error) => error.to_string(),
    };
    again::read(first, Again { connect: move || connect(&address), pause: PAUSE, why }, to);
    Ok(())
}
