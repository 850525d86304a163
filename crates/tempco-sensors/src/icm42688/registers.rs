//! Registers of the ICM-42688-P, by its data sheet DS-000347.

/// Set in an address that is read.
pub(super) const READ: u8 = 0x80;

// Bank 0.
pub(super) const DEVICE_CONFIG: u8 = 0x11;
pub(super) const INT_CONFIG: u8 = 0x14;
pub(super) const FIFO_CONFIG: u8 = 0x16;
/// The FIFO's count and data follow it; at the data the address stays.
pub(super) const INT_STATUS: u8 = 0x2d;
pub(super) const FIFO_DATA: u8 = 0x30;
pub(super) const SIGNAL_PATH_RESET: u8 = 0x4b;
pub(super) const INTF_CONFIG0: u8 = 0x4c;
pub(super) const INTF_CONFIG1: u8 = 0x4d;
pub(super) const PWR_MGMT0: u8 = 0x4e;
pub(super) const GYRO_CONFIG0: u8 = 0x4f;
pub(super) const ACCEL_CONFIG0: u8 = 0x50;
pub(super) const GYRO_ACCEL_CONFIG0: u8 = 0x52;
pub(super) const TMST_CONFIG: u8 = 0x54;
pub(super) const FIFO_CONFIG1: u8 = 0x5f;
pub(super) const FIFO_CONFIG2: u8 = 0x60;
pub(super) const FIFO_CONFIG3: u8 = 0x61;
pub(super) const INT_CONFIG1: u8 = 0x64;
pub(super) const INT_SOURCE0: u8 = 0x65;
pub(super) const WHO_AM_I: u8 = 0x75;
/// In every bank.
pub(super) const REG_BANK_SEL: u8 = 0x76;

// Bank 1: the anti-alias filter of the gyro, in three registers one after the other.
pub(super) const GYRO_CONFIG_STATIC3: u8 = 0x0c;

/// What `WHO_AM_I` says.
pub(super) const IDENTITY: u8 = 0x47;

/// `DEVICE_CONFIG`: resets the chip, which takes the bit back.
pub(super) const SOFT_RESET: u8 = 0x01;

/// `INT_STATUS`: the chip has been reset since it was read last.
pub(super) const RESET_DONE: u8 = 0x10;
/// `INT_STATUS`: the FIFO has been full since it was read last.
pub(super) const FIFO_FULL: u8 = 0x02;

/// `SIGNAL_PATH_RESET`: empties the FIFO.
pub(super) const FIFO_FLUSH: u8 = 0x02;

/// `FIFO_CONFIG`: a full FIFO keeps what it has. So what was lost is one stretch.
pub(super) const STOP_ON_FULL: u8 = 0xc0;
/// `PWR_MGMT0`: gyros and accelerometers on, with low noise.
pub(super) const ALL_ON: u8 = 0x0f;

/// Bytes that the FIFO can hold, with the cache before it.
pub(super) const FIFO_BYTES: u16 = 2080;
/// Bytes of a packet with both sensors, temperature and time.
pub(super) const PACKET: usize = 16;
/// The header of such a packet, without the bits below.
pub(super) const HEADER: u8 = 0x68;
/// Bits of a header that say that a rate was changed.
pub(super) const RATE_CHANGED: u8 = 0x03;
