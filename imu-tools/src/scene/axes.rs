//! Numbers for three axes as scene files write them: one for all, three, or a matrix.

use std::fmt;

use serde::Deserialize;
use serde::de::{self, Deserializer, SeqAccess, Visitor};

/// A number for each of x, y and z; in a scene file one for all, or three.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axes(pub [f64; 3]);

/// What to say of a number in quotes.
fn no_unit<T, E: de::Error>(text: &str) -> Result<T, E> {
    Err(E::custom(format!(
        "\"{text}\" is text: give a plain number, in the unit that the key has in docs/scenes.md"
    )))
}

impl<'de> Deserialize<'de> for Axes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Numbers;

        impl<'de> Visitor<'de> for Numbers {
            type Value = Axes;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number for all axes, or three, [x, y, z]")
            }

            fn visit_f64<E: de::Error>(self, x: f64) -> Result<Axes, E> {
                Ok(Axes([x; 3]))
            }

            fn visit_i64<E: de::Error>(self, x: i64) -> Result<Axes, E> {
                Ok(Axes([x as f64; 3]))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Axes, E> {
                no_unit(text)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Axes, A::Error> {
                let mut axes = [0.0; 3];
                for (i, axis) in axes.iter_mut().enumerate() {
                    *axis = seq
                        .next_element::<f64>()?
                        .ok_or_else(|| de::Error::invalid_length(i, &self))?;
                }
                if seq.next_element::<f64>()?.is_some() {
                    return Err(de::Error::invalid_length(4, &self));
                }
                Ok(Axes(axes))
            }
        }

        from.deserialize_any(Numbers)
    }
}

/// The same as an array.
pub(super) fn three<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 3], D::Error> {
    Axes::deserialize(from).map(|Axes(axes)| axes)
}

/// A matrix as a scene file may write it.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected a matrix of plain numbers, [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]], or \
                 its diagonal"
)]
enum Matrix {
    One(f64),
    Diagonal([f64; 3]),
    Rows([[f64; 3]; 3]),
}

/// A matrix, row by row; in a scene file also its diagonal: one number for all of it, or three.
pub(super) fn matrix<'de, D: Deserializer<'de>>(from: D) -> Result<[[f64; 3]; 3], D::Error> {
    let [x, y, z] = match Matrix::deserialize(from)? {
        Matrix::One(x) => [x; 3],
        Matrix::Diagonal(diagonal) => diagonal,
        Matrix::Rows(rows) => return Ok(rows),
    };
    Ok([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
}

/// The same where it may be left out.
pub(super) fn maybe_matrix<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<[[f64; 3]; 3]>, D::Error> {
    matrix(from).map(Some)
}
