//! Flash images as files: reads one, shows one, compares one with the set it should be made from.

use std::fs;
use std::path::Path;

use anyhow::{Context, Error, Result, ensure};
use tempco_image::{AlignedBytes, Channel, Image, ImageError};
use tempco_set::{check_folder, read_set, table_bin};

use crate::Exit;
use crate::output::{print_wrapped, say};

/// No image is longer.
const MOST_BYTES: usize = 1 << 18;

/// Whether a set is a flash image, by the name of its file.
pub(crate) fn is_image(set: &Path) -> bool {
    set.extension().is_some_and(|name| name == "bin")
}

/// The bytes of an image at an aligned place, so that its cells can be used in place.
pub(crate) struct Placed {
    place: Box<AlignedBytes<MOST_BYTES>>,
    len: usize,
}

impl Placed {
    /// Reads a file that holds one image only.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let name = path.display();
        let bytes = fs::read(path).with_context(|| name.to_string())?;
        ensure!(
            bytes.len() <= MOST_BYTES,
            "{name}: {} bytes: expected a flash image of at most {MOST_BYTES}",
            bytes.len()
        );
        let placed = Self::of(&bytes);
        let image = placed.image().with_context(|| name.to_string())?;
        let len = image.bytes().len();
        ensure!(
            len == bytes.len(),
            "{name}: {} bytes behind the image of {len}",
            bytes.len() - len,
        );
        Ok(placed)
    }

    /// Places bytes that are an image.
    pub(crate) fn of(bytes: &[u8]) -> Self {
        let mut place = Box::new(AlignedBytes([0; MOST_BYTES]));
        place.0[..bytes.len()].copy_from_slice(bytes);
        Self {
            place,
            len: bytes.len(),
        }
    }

    /// The bytes.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.place.0[..self.len]
    }

    /// The image, with its contents validated.
    pub(crate) fn image(&self) -> Result<Image<'_>, ImageError> {
        let image = Image::read(self.bytes())?;
        image.validate().map(|()| image)
    }
}

/// Whether the files in the folder of a set or image are of one set. Names those that are not.
pub(crate) fn is_folder_whole(path: &Path) -> bool {
    let checked = check_folder(path);
    if let Err(error) = &checked {
        say!("{error}");
    }
    checked.is_ok()
}

/// Shows an image, with all its settings if `in_full`, and compares it with the set `against`.
pub(crate) fn inspect(path: &Path, against: Option<&Path>, in_full: bool) -> Result<Exit> {
    let name = path.display();
    let placed = Placed::read(path)?;
    show(&placed.image()?, in_full)?;
    let is_whole = is_folder_whole(path);
    let Some(set) = against else {
        return Ok(Exit::of(is_whole));
    };
    let same = table_bin(&read_set(set)?).map_err(Error::msg)? == placed.bytes();
    if same {
        print_wrapped(&format!("the image is that of {}", set.display()))?;
    } else {
        say!("{name} is not the image of {}", set.display());
    }
    Ok(Exit::of(same && is_whole))
}

fn show(image: &Image, in_full: bool) -> Result<()> {
    let (format, model, info) = (image.format(), image.model(), image.info());
    print_wrapped(&format!(
        "unit {}, table CRC-32P4 {:08x}",
        info.serial, info.table_crc
    ))?;
    print_wrapped(&format!(
        "flash image, layout {}.{}, model {}.{}, {} bytes in {} block(s), all CRCs right, {}",
        format.0,
        format.1,
        model.0,
        model.1,
        image.bytes().len(),
        image.blocks(),
        if info.continuous {
            "continuous"
        } else {
            "with jumps between cells"
        }
    ))?;
    for number in 0..image.channels() {
        show_channel(number, &image.channel(number)?, in_full)?;
    }
    Ok(())
}

fn show_channel(number: usize, channel: &Channel, in_full: bool) -> Result<()> {
    let s = &channel.thermal;
    let axes = || channel.axes.iter().flatten();
    let units: Vec<&str> = axes().map(|axis| axis.unit.symbol()).collect();
    print_wrapped(&format!(
        "channel {number}: {} to {} degC, {} to {} degC/min; {} cells from {} to {} degC; axes in {}",
        channel.t_min_c,
        channel.t_max_c,
        s.rate_min_c_per_min,
        s.rate_max_c_per_min,
        channel.cells.len() / units.len(),
        channel.first_edge_c,
        channel.last_edge_c,
        units.join(", "),
    ))?;
    let half_widths_c = [s.half_width1_c, s.half_width2_c].into_iter().enumerate();
    for (play, half_width_c) in half_widths_c.filter(|(_, width_c)| *width_c > 0.0) {
        let gains = axes().zip(&units);
        let gains = gains.map(|(axis, unit)| format!("{} {unit}", axis.play_gains[play]));
        print_wrapped(&format!(
            "play: half width {half_width_c} degC, gain per degC {}",
            gains.collect::<Vec<_>>().join(", ")
        ))?;
    }
    if s.has_lag2() {
        print_wrapped(&format!(
            "second lag: tau {} s, {} to {} degC",
            s.tau2_s, s.lag2_min_c, s.lag2_max_c
        ))?;
    }
    if !in_full {
        return Ok(());
    }
    print_wrapped(&format!(
        "rate estimator tau {} s, kappa {}; sensor {} to {} degC, spike gate {} degC, slew {} \
         degC/min, hold {} s, heal {} s, reference {} degC",
        s.tau_s,
        s.kappa,
        s.sensor_min_c,
        s.sensor_max_c,
        s.spike_gate_c,
        s.max_slew_c_per_min,
        s.hold_s,
        s.heal_s,
        s.reference_c,
    ))
}
