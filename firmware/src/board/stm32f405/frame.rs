//! The frames that go out with every sample, for whoever navigates.
//!
//! 24 bytes, little-endian; at 921600 baud they take 260 us of the 500 us between samples.
//!
//! | offset | type | content |
//! |---|---|---|
//! | 0 | u16 | 0xeb90 |
//! | 2 | u16 | number of the sample; wraps, and a gap is a frame that was not sent |
//! | 4 | 3 f32 | axes x, y, z, compensated \[unit of the axis\]; NaN where there is none |
//! | 16 | 3 u16 | bits of [`tempco::Status`] for each axis |
//! | 22 | u16 | CRC-16/IBM-3740 of the 22 bytes before |

use crc::{CRC_16_IBM_3740, Crc, Table};
use tempco::Status;

use super::AXES;

/// Bytes of a frame.
pub const LEN: usize = 24;

const MAGIC: u16 = 0xeb90;

/// By a table of 512 bytes: bit by bit it would take the interrupt 5 us.
static CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_3740);

/// The frame of a sample.
pub fn encode<const C: usize, const A: usize>(
    number: u16,
    compensated: &[[f32; A]; C],
    status: &[Status; C],
) -> [u8; LEN] {
    const { assert!(C * A <= AXES, "the board has three axes") };
    let mut bytes = [0; LEN];
    bytes[0..2].copy_from_slice(&MAGIC.to_le_bytes());
    bytes[2..4].copy_from_slice(&number.to_le_bytes());
    let channels = compensated.iter().zip(status);
    let mut axes =
        channels.flat_map(|(values, status)| values.iter().map(|value| (*value, status.bits())));
    for axis in 0..AXES {
        let (value, status) = axes.next().unwrap_or((f32::NAN, 0));
        bytes[4 + 4 * axis..8 + 4 * axis].copy_from_slice(&value.to_le_bytes());
        bytes[16 + 2 * axis..18 + 2 * axis].copy_from_slice(&status.to_le_bytes());
    }
    let crc = CRC.checksum(&bytes[..LEN - 2]);
    bytes[LEN - 2..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_as_documented() {
        let expected = [
            0x90, 0xeb, 0x34, 0x12, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0x3f, 2, 1, 2, 1, 2,
            1,
        ];
        let frame = encode(0x1234, &[[1.0, -2.0, 0.5]], &[Status::from_bits(0x0102)]);
        assert_eq!(frame[..22], expected);
        assert_eq!(
            bitwise_crc(&frame[..22]),
            u16::from_le_bytes([frame[22], frame[23]])
        );
        assert_eq!(bitwise_crc(b"123456789"), 0x29b1);
    }

    /// The definition: polynomial 0x1021, initial value 0xffff.
    fn bitwise_crc(bytes: &[u8]) -> u16 {
        bytes.iter().fold(0xffff, |crc, byte| {
            (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
                (crc << 1) ^ if crc & 0x8000 == 0 { 0 } else { 0x1021 }
            })
        })
    }

    #[test]
    fn axes_of_any_channels_are_in_order_and_missing_ones_are_marked() {
        let status = [1, 2].map(Status::from_bits);
        let frame = encode(0, &[[1.0], [2.0]], &status);
        let value = |axis: usize| {
            let at = 4 + 4 * axis;
            f32::from_le_bytes(frame[at..at + 4].try_into().unwrap())
        };
        assert_eq!([value(0), value(1)], [1.0, 2.0]);
        assert!(value(2).is_nan());
        assert_eq!(frame[16..22], [1, 0, 2, 0, 0, 0]);
    }
}
