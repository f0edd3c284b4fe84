use super::*;
use crate::allan::{AllanLadder, HadamardLadder};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::{vec, vec::Vec};

/// Sample `k` of a repeatable record with an offset; every 97th is no number.
fn sample<T: Real, const AXES: usize>(k: u64) -> [T; AXES] {
    let mut state = k.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    [(); AXES].map(|()| {
        state ^= state >> 29;
        state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let uniform = (state >> 11) as f64 / (1_u64 << 53) as f64;
        T::from_f64(if k % 97 == 96 { f64::NAN } else { 9.81 + uniform })
    })
}

/// Bytes of a ladder; of exactly as many as it says.
fn bytes_of<T: Real, const A: usize, const L: usize, const W: usize, const O: usize>(
    ladder: &Ladder<T, A, L, W, O>,
) -> Vec<u8> {
    let mut bytes = vec![0xaa; Ladder::<T, A, L, W, O>::BYTES];
    assert_eq!(ladder.write_to(&mut bytes), Ok(bytes.len()));
    bytes
}

/// Stores and reads a ladder after `at` samples; both must then go on alike.
fn survives<T: Real, const W: usize, const O: usize>(at: u64, hole: u64) {
    let mut ladder = Ladder::<T, 2, 9, W, O>::new();
    (0..at).for_each(|k| ladder.push(&sample(k)));
    ladder.missing(hole);
    let mut copy = Ladder::read_from(&bytes_of(&ladder)).unwrap();
    assert_eq!(copy, ladder);
    for k in at..at + 700 {
        ladder.push(&sample(k));
        copy.push(&sample(k));
    }
    assert_eq!(copy, ladder);
    assert_eq!(bytes_of(&copy), bytes_of(&ladder));
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        rng_seed: RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_ladder_survives_at_any_moment(at in 0_u64..1500, early in 0_u64..20, hole in 0_u64..300) {
        for at in [at, early] {
            survives::<f32, 1, 1>(at, hole);
            survives::<f32, 4, 2>(at, hole);
            survives::<f64, 4, 1>(at, hole);
            survives::<f64, 1, 2>(at, hole);
        }
    }

    /// Bytes with a right checksum and any content: refused, or a ladder that works.
    #[test]
    fn a_forged_ladder_is_refused_or_works(
        at in 0_u64..200,
        forged in prop::collection::vec((0_usize..4096, any::<u8>()), 1..12),
    ) {
        let mut ladder = AllanLadder::<f32, 2, 9, 4>::new();
        (0..at).for_each(|k| ladder.push(&sample(k)));
        let mut bytes = bytes_of(&ladder);
        let body = bytes.len() - CRC;
        for (place, byte) in forged {
            bytes[HEADER + place % (body - HEADER)] = byte;
        }
        seal(&mut bytes);
        if let Ok(mut ladder) = AllanLadder::<f32, 2, 9, 4>::read_from(&bytes) {
            for k in 0..300 {
                ladder.push(&sample(k));
            }
            ladder.missing(70);
            ladder.extend(&[[9.0, 10.0]; 200]);
            ladder.missing(u64::MAX);
            ladder.restart();
            prop_assert!(ladder.octaves(0).iter().all(|octave| !octave.variance.is_nan()));
        }
    }
}

/// Puts the right checksum at the end.
fn seal(bytes: &mut [u8]) {
    let (body, crc) = bytes.split_last_chunk_mut().unwrap();
    *crc = crc32(body).to_le_bytes();
}

#[test]
fn the_checksum_is_the_one_of_ethernet() {
    // The check value that catalogues of CRCs give for it.
    assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
}

#[test]
fn every_flipped_bit_and_every_lost_byte_is_found() {
    type Small = AllanLadder<f32, 1, 3>;
    let mut ladder = Small::new();
    (0..40).for_each(|k| ladder.push(&sample(k)));
    let bytes = bytes_of(&ladder);
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(matches!(Small::read_from(&flipped), Err(Error::Corrupt(_))), "bit {bit}");
    }
    for length in 0..bytes.len() {
        assert!(matches!(Small::read_from(&bytes[..length]), Err(Error::Corrupt(_))));
        assert!(ladder.write_to(&mut vec![0; length]).is_err());
    }
    let mut long = bytes.clone();
    long.push(0);
    assert_eq!(Small::read_from(&long), Err(Error::Corrupt("wrong length")));
    assert_eq!(ladder.write_to(&mut long), Ok(Small::BYTES));
}

#[test]
fn bytes_of_another_type_are_refused() {
    let bytes = bytes_of(&AllanLadder::<f32, 2, 8>::new());
    let refused = Err(Error::Corrupt("a ladder of another type or version"));
    assert_eq!(AllanLadder::<f64, 2, 8>::read_from(&bytes).map(|_| ()), refused);
    assert_eq!(AllanLadder::<f32, 3, 8>::read_from(&bytes).map(|_| ()), refused);
    assert_eq!(AllanLadder::<f32, 2, 9>::read_from(&bytes).map(|_| ()), refused);
    assert_eq!(AllanLadder::<f32, 2, 8, 4>::read_from(&bytes).map(|_| ()), refused);
    assert_eq!(HadamardLadder::<f32, 2, 8>::read_from(&bytes).map(|_| ()), refused);
    let mut newer = bytes.clone();
    newer[4] += 1;
    seal(&mut newer);
    assert_eq!(AllanLadder::<f32, 2, 8>::read_from(&newer).map(|_| ()), refused);
    assert_eq!(
        AllanLadder::<f32, 2, 8>::read_from(&[b'x'; 99]).map(|_| ()),
        Err(Error::Corrupt("no ladder"))
    );
}

#[test]
fn impossible_states_are_refused() {
    type Small = AllanLadder<f64, 1, 4>;
    let reason = |change: fn(&mut Small)| {
        let mut ladder = Small::with_reference([9.0], [10.0]).unwrap();
        (0..40).for_each(|k| ladder.push(&sample(k)));
        change(&mut ladder);
        match Small::read_from(&bytes_of(&ladder)) {
            Err(Error::Corrupt(reason)) => reason,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(reason(|l| l.held = 4), "more samples wait than can");
    assert_eq!(reason(|l| l.held = 2), "a block holds more samples than it can");
    assert_eq!(reason(|l| l.counts[1][0][0] = 3), "a block holds more samples than it can");
    assert_eq!(reason(|l| l.reference = [f64::NAN]), "reference is not finite");
    assert_eq!(reason(|l| l.bound = [f64::INFINITY]), "bound is out of range");
    assert_eq!(reason(|l| l.bound = [0.0]), "bound is out of range");
    assert_eq!(reason(|l| l.history[2][0][0] = [f64::NAN]), "a block's sum is out of range");
    assert_eq!(reason(|l| l.history[0][0][0] = [1e101]), "a block's sum is out of range");
    let total = "a total of squares is negative or not a number";
    assert_eq!(reason(|l| l.squares[3] = [f64::NAN]), total);
    assert_eq!(reason(|l| l.excess[0] = -1.0), total);
}

/// The layout is a promise: another checksum here is another version of it.
#[test]
fn the_layout_is_stable() {
    let mut ladder = AllanLadder::<f32, 2, 6, 4>::new();
    (0..300).for_each(|k| ladder.push(&sample(k)));
    ladder.missing(5);
    let bytes = bytes_of(&ladder);
    assert_eq!(bytes[..16], *b"IMUL\x01\x04\x06\x04\x01\0\0\0\x02\0\0\0");
    assert_eq!(bytes.len(), 16 + 8 + 24 + 16 + 6 * (16 + 16) + 24 * (8 + 4) + 4);
    assert_eq!(bytes[bytes.len() - CRC..], [100, 35, 247, 41]);
}
