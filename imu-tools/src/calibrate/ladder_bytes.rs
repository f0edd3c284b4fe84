//! A ladder in a checkpoint: as its own bytes, which carry version and checksum.

use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serializer};

use super::SensorLadder;

/// The bytes of a ladder.
fn bytes(ladder: &SensorLadder) -> Option<Vec<u8>> {
    let mut bytes = vec![0; SensorLadder::BYTES];
    ladder.write_to(&mut bytes).ok().map(|_| bytes)
}

/// For `serde(with)`.
pub(super) fn serialize<S: Serializer>(ladder: &SensorLadder, to: S) -> Result<S::Ok, S::Error> {
    let bytes = bytes(ladder).ok_or_else(|| S::Error::custom("a ladder of another size"))?;
    to.serialize_bytes(&bytes)
}

/// For `serde(with)`.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<SensorLadder, D::Error> {
    let bytes: &[u8] = Deserialize::deserialize(from)?;
    SensorLadder::read_from(bytes).map_err(|e| D::Error::custom(format!("{e:?}")))
}

/// The same of a ladder that may not be there: no bytes.
pub(super) mod optional {
    use super::{Deserialize, Deserializer, SensorLadder, Serializer};
    use serde::de::Error as _;
    use serde::ser::Error as _;

    /// For `serde(with)`.
    pub(in crate::calibrate) fn serialize<S: Serializer>(
        ladder: &Option<SensorLadder>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        match ladder {
            None => to.serialize_bytes(&[]),
            Some(ladder) => {
                let bytes = super::bytes(ladder);
                to.serialize_bytes(&bytes.ok_or_else(|| S::Error::custom("another size"))?)
            }
        }
    }

    /// For `serde(with)`.
    pub(in crate::calibrate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<SensorLadder>, D::Error> {
        let bytes: &[u8] = Deserialize::deserialize(from)?;
        if bytes.is_empty() {
            return Ok(None);
        }
        SensorLadder::read_from(bytes).map(Some).map_err(|e| D::Error::custom(format!("{e:?}")))
    }
}
