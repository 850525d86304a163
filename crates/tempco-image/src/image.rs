//! Reads an image where it lies.

use tempco::{MAX_AXES, MAX_CELLS, Table, Terms, ThermalSettings};
use zerocopy::FromBytes;
use zerocopy::little_endian::{F32, U16};

use crate::check::{check_block, split};
use crate::layout::{
    AXIS_LEN, CHANNEL_LEN, CONTINUOUS, HEADER_CRC_AT, HEADER_LEN, RawAxis, RawChannel, RawHeader,
    TERMS_LEN,
};
use crate::{
    Axis, CRC, Channel, FORMAT, ImageError, MAGIC, MAX_CELLS_LEN, MAX_SIGNATURE_LEN, MODEL,
};

/// What an image says about itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Info<'a> {
    /// Serial number of the unit: 1 to 32 bytes without control characters.
    pub serial: &'a str,
    /// The CRC that `coefficients.json` and `table.rs` name, by which a set is recognised.
    pub table_crc: u32,
    /// Whether the biases of neighbouring cells meet; it is checked.
    pub continuous: bool,
    /// Grows with every table that is released, where tables are signed.
    pub security_counter: u32,
    /// The key of the signature; 0 where there is none.
    pub key_id: u16,
    /// The signature: a multiple of 4 bytes, at most [`MAX_SIGNATURE_LEN`]. It is not interpreted
    /// here.
    pub signature: &'a [u8],
}

impl Info<'_> {
    /// Whether the signature has a length that it may have, and a key exactly where it has bytes.
    pub(crate) fn is_signature_usable(&self) -> bool {
        let len = self.signature.len();
        len <= MAX_SIGNATURE_LEN && len.is_multiple_of(4) && (len > 0) == (self.key_id != 0)
    }
}

/// An image whose integrity was checked.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    /// The image without what may lie behind it.
    bytes: &'a [u8],
    info: Info<'a>,
    format: (u16, u16),
    model: (u16, u16),
    header_len: usize,
    channel_len: usize,
    axis_len: usize,
    channels: usize,
    axes: usize,
}

impl<'a> Image<'a> {
    /// Reads the image that `bytes` begin with; what lies behind it, such as the rest of a flash
    /// sector, is passed over.
    ///
    /// # Errors
    /// No image or another major version, a wrong CRC, or lengths, counts and codes that are out
    /// of range or do not agree. The contents of the tables are not yet looked at.
    pub fn read(bytes: &'a [u8]) -> Result<Self, ImageError> {
        let header = header(bytes)?;
        let total_len = header.total_len.get() as usize;
        let bytes = bytes.get(..total_len).ok_or(ImageError::Short {
            given: bytes.len(),
            needed: total_len,
        })?;
        let pair = |versions: [U16; 2]| {
            let [major, minor] = versions;
            (major.get(), minor.get())
        };
        let signature_len = header.signature_len.get().into();
        let mut image = Self {
            bytes,
            info: info(header)?,
            format: pair(header.format),
            model: pair(header.model),
            header_len: header.header_len.get().into(),
            channel_len: header.channel_len.get().into(),
            axis_len: header.axis_len.get().into(),
            channels: header.channels.into(),
            axes: header.axes.into(),
        };
        image.check_counts()?;
        (0..image.blocks()).try_for_each(|block| check_block(bytes, block))?;
        image.info.signature = image.check_channels(signature_len)?;
        if !image.info.is_signature_usable() {
            return Err(ImageError::Field("signature"));
        }
        Ok(image)
    }

    fn check_counts(&self) -> Result<(), ImageError> {
        // Only a newer minor version may have more fields than this reader knows.
        let known = self.format.1 <= FORMAT.1;
        let is_len = |len: usize, least: usize| {
            len == least || (!known && len > least && len.is_multiple_of(4))
        };
        for (good, name) in [
            (split(self.bytes).is_some(), "total_len"),
            (is_len(self.header_len, HEADER_LEN), "header_len"),
            (is_len(self.channel_len, CHANNEL_LEN), "channel_len"),
            (is_len(self.axis_len, AXIS_LEN), "axis_len"),
            (self.channels > 0, "channels"),
            (
                self.axes > 0 && self.channels * self.axes <= MAX_AXES,
                "axes",
            ),
        ] {
            if !good {
                return Err(ImageError::Field(name));
            }
        }
        Ok(())
    }

    /// The channels and the signature must fill the contents exactly; returns the signature.
    fn check_channels(&self, signature_len: usize) -> Result<&'a [u8], ImageError> {
        let mut at = self.header_len;
        let mut cells_len: usize = 0;
        for _ in 0..self.channels {
            let (channel, end) = self.channel_at(at)?;
            cells_len = cells_len.saturating_add(size_of_val(channel.cells));
            at = end;
        }
        if cells_len > MAX_CELLS_LEN {
            return Err(ImageError::TooLarge { cells_len });
        }
        let signature = split(self.bytes).and_then(|(contents, _)| contents.get(at..));
        signature
            .filter(|signature| signature.len() == signature_len)
            .ok_or(ImageError::Field("total_len"))
    }

    /// The channel that begins at a place, and where it ends.
    fn channel_at(&self, at: usize) -> Result<(Channel<'a>, usize), ImageError> {
        const CELLS: ImageError = ImageError::Field("cells");
        let (contents, _) = split(self.bytes).ok_or(ImageError::Field("total_len"))?;
        let rest = contents.get(at..).ok_or(CELLS)?;
        let (head, _) = RawChannel::ref_from_prefix(rest).map_err(|_| CELLS)?;
        let count = head.cells.get() as usize;
        if !(1..=MAX_CELLS).contains(&count) {
            return Err(CELLS);
        }
        let axes_len = self.axes.saturating_mul(self.axis_len);
        let begin = self.channel_len.saturating_add(axes_len);
        let axes = rest.get(self.channel_len..begin).ok_or(CELLS)?;
        let cells_len = count.saturating_mul(self.axes).saturating_mul(TERMS_LEN);
        let end = begin.saturating_add(cells_len);
        let cells = rest.get(begin..end).ok_or(CELLS)?;
        let cells = <[Terms]>::ref_from_bytes(cells).map_err(|_| ImageError::Alignment)?;
        let channel = Channel {
            thermal: ThermalSettings::from_array(head.thermal.map(F32::get)),
            first_edge_c: head.first_edge_c.get(),
            last_edge_c: head.last_edge_c.get(),
            t_min_c: head.t_min_c.get(),
            t_max_c: head.t_max_c.get(),
            period_s: head.period_s.get(),
            axes: self.records(axes)?,
            cells,
        };
        Ok((channel, at.saturating_add(end)))
    }

    /// The records of the axes of a channel.
    fn records(&self, bytes: &[u8]) -> Result<[Option<Axis>; MAX_AXES], ImageError> {
        let mut axes = [None; MAX_AXES];
        // `axis_len` is at least the length of a record, so it is not zero.
        for (axis, bytes) in axes
            .iter_mut()
            .zip(bytes.chunks_exact(self.axis_len.max(1)))
        {
            let record = RawAxis::ref_from_prefix(bytes);
            let (raw, _) = record.map_err(|_| ImageError::Field("axis_len"))?;
            *axis = Some(Axis::from_raw(raw)?);
        }
        Ok(axes)
    }

    /// A table, with its cells borrowed from the image, for a program that was compiled for so
    /// many axes.
    ///
    /// # Errors
    /// [`ImageError::Shape`] where there is no such channel or it has not `AXES` axes; settings,
    /// grid, cells or gains that the core refuses; a number of an axis that is not finite or below
    /// zero; a jump where the image is marked as continuous.
    pub fn table<const AXES: usize>(&self, channel: usize) -> Result<Table<'a, AXES>, ImageError> {
        let data = self.channel(channel)?;
        let table = data.table(channel)?;
        self.check_jumps(channel, &data)?;
        Ok(table)
    }

    /// The tables of all channels.
    ///
    /// # Errors
    /// As [`table`](Self::table), and another number of channels.
    pub fn tables<const CHANNELS: usize, const AXES: usize>(
        &self,
    ) -> Result<[Table<'a, AXES>; CHANNELS], ImageError> {
        if self.channels != CHANNELS {
            return Err(ImageError::Shape);
        }
        let first = self.table(0)?;
        let mut tables = [first; CHANNELS];
        for (channel, table) in tables.iter_mut().enumerate() {
            *table = self.table(channel)?;
        }
        Ok(tables)
    }

    /// Checks the contents of all channels, whatever their shape.
    ///
    /// # Errors
    /// As [`table`](Self::table).
    pub fn validate(&self) -> Result<(), ImageError> {
        (0..self.channels).try_for_each(|channel| {
            let data = self.channel(channel)?;
            data.check(channel)?;
            self.check_jumps(channel, &data)
        })
    }

    fn check_jumps(&self, channel: usize, data: &Channel) -> Result<(), ImageError> {
        match data.jump().filter(|_| self.info.continuous) {
            Some((cell, axis)) => Err(ImageError::Jump {
                channel,
                cell,
                axis,
            }),
            None => Ok(()),
        }
    }

    /// A channel as it is, not validated; for showing it.
    ///
    /// # Errors
    /// [`ImageError::Shape`] where there is no such channel.
    pub fn channel(&self, channel: usize) -> Result<Channel<'a>, ImageError> {
        if channel >= self.channels {
            return Err(ImageError::Shape);
        }
        let mut at = self.header_len;
        for _ in 0..channel {
            at = self.channel_at(at)?.1;
        }
        Ok(self.channel_at(at)?.0)
    }

    /// Checks one block again, as a periodic check does, one block at a time.
    ///
    /// # Errors
    /// A wrong CRC, or no such block.
    pub fn check_block(&self, block: usize) -> Result<(), ImageError> {
        check_block(self.bytes, block)
    }

    /// Number of blocks with a CRC of their own.
    pub const fn blocks(&self) -> usize {
        self.bytes.len().div_ceil(crate::BLOCK_LEN + 4)
    }

    /// What the image says about itself.
    pub const fn info(&self) -> &Info<'a> {
        &self.info
    }

    /// Checks that the image is of a unit.
    ///
    /// # Errors
    /// [`ImageError::Serial`].
    pub fn expect_serial(&self, serial: &str) -> Result<(), ImageError> {
        if self.info.serial == serial {
            Ok(())
        } else {
            Err(ImageError::Serial)
        }
    }

    /// The image, without what may lie behind it.
    pub const fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// Version of the layout, major and minor.
    pub const fn format(&self) -> (u16, u16) {
        self.format
    }

    /// Version of the equations, major and minor.
    pub const fn model(&self) -> (u16, u16) {
        self.model
    }

    /// Number of temperature channels.
    pub const fn channels(&self) -> usize {
        self.channels
    }

    /// Number of axes of each channel.
    pub const fn axes(&self) -> usize {
        self.axes
    }
}

/// The header, of a version this reader knows and undamaged.
fn header(bytes: &[u8]) -> Result<&RawHeader, ImageError> {
    let short = ImageError::Short {
        given: bytes.len(),
        needed: HEADER_LEN,
    };
    let (header, _) = RawHeader::ref_from_prefix(bytes).map_err(|_| short)?;
    if header.magic != MAGIC {
        return Err(ImageError::Magic);
    }
    let [format, model] = [header.format, header.model].map(|[major, _]| major.get());
    if format != FORMAT.0 {
        return Err(ImageError::Format { major: format });
    }
    let covered = bytes.get(..HEADER_CRC_AT).ok_or(short)?;
    if CRC.checksum(covered) != header.header_crc.get() {
        return Err(ImageError::Header);
    }
    if model != MODEL.0 {
        return Err(ImageError::Model { major: model });
    }
    Ok(header)
}

fn info(header: &RawHeader) -> Result<Info<'_>, ImageError> {
    const SERIAL: ImageError = ImageError::Field("serial");
    let len = header.serial.iter().rposition(|&byte| byte != 0);
    let text = header.serial.get(..=len.ok_or(SERIAL)?).ok_or(SERIAL)?;
    let serial = core::str::from_utf8(text).map_err(|_| SERIAL)?;
    if serial.chars().any(char::is_control) {
        return Err(SERIAL);
    }
    let flags = header.flags.get();
    let [_, minor] = header.format;
    if flags & !CONTINUOUS != 0 && minor.get() <= FORMAT.1 {
        return Err(ImageError::Field("flags"));
    }
    Ok(Info {
        serial,
        table_crc: header.table_crc.get(),
        continuous: flags & CONTINUOUS != 0,
        security_counter: header.security_counter.get(),
        key_id: header.key_id.get(),
        // Behind the channels, which come later.
        signature: &[],
    })
}
