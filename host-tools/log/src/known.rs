//! Layouts of known loggers, by their column names.

use super::mapping::Mapping;

/// A known layout.
pub(crate) struct Known {
    /// As it is said.
    pub(crate) name: &'static str,
    /// Its columns.
    pub(crate) mapping: Mapping,
    /// The column that numbers the sources, of which a log should have one.
    pub(crate) source: Option<&'static str>,
    /// What else must be said.
    pub(crate) warning: Option<&'static str>,
}

/// Where a layout is looked for.
pub(crate) struct Signs<'a> {
    pub(crate) header: &'a [String],
    /// Name of the file.
    pub(crate) file: &'a str,
    /// Lines before the header.
    pub(crate) preamble: &'a [Vec<u8>],
    /// Cells of the first rows.
    pub(crate) sample: &'a [Vec<Vec<u8>>],
    /// Whether the rows of each source stand apart, in a binary log.
    pub(crate) has_instances: bool,
}

impl Signs<'_> {
    fn has(&self, names: &[&str]) -> bool {
        names
            .iter()
            .all(|name| self.header.iter().any(|column| column == name))
    }

    fn first_of(&self, names: &[&'static str]) -> Option<&'static str> {
        names.iter().copied().find(|name| self.has(&[name]))
    }
}

/// Columns of three axes.
fn axes(names: [&str; 3], columns: [&str; 3], unit: &str) -> Vec<String> {
    let axes = names.iter().zip(columns);
    axes.map(|(name, column)| format!("{name}={column}:{unit}"))
        .collect()
}

const GYROS: [&str; 3] = ["gx", "gy", "gz"];

impl Known {
    fn new(name: &'static str, time: &str, temp: Option<&str>, axis: Vec<String>) -> Self {
        Self {
            name,
            mapping: Mapping {
                time: Some(time.to_owned()),
                temp: temp
                    .map(|temp| format!("{temp}:degc"))
                    .into_iter()
                    .collect(),
                axis,
                ..Mapping::default()
            },
            source: None,
            warning: None,
        }
    }
}

/// The layout of a header, whose axes may be named by the user; `None` of an unknown one.
///
/// # Errors
/// A layout that two loggers write.
pub(crate) fn recognise(signs: &Signs, has_axes: bool) -> Result<Option<Known>, String> {
    if let Some(known) = px4(signs, has_axes)? {
        return Ok(Some(known));
    }
    let layouts = [ardupilot, flysight, xsens, kalibr];
    for layout in layouts {
        if let Some(known) = layout(signs)? {
            return Ok(Some(known));
        }
    }
    Ok(None)
}

/// PX4, as `ulog2csv` writes it. Gyros and accelerometers have the same columns: the name of the file
/// says which they are.
fn px4(signs: &Signs, has_axes: bool) -> Result<Option<Known>, String> {
    const TIME: &str = "timestamp:us";
    if signs.has(&["timestamp", "gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"]) {
        let columns = ["gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"];
        let axes = axes(GYROS, columns, "radps");
        return Ok(Some(Known::new("PX4 sensor_combined", TIME, None, axes)));
    }
    if !signs.has(&["timestamp", "device_id", "x", "y", "z", "temperature"]) {
        return Ok(None);
    }
    let columns = ["x", "y", "z"];
    let known = |name, names, unit| {
        let axes = axes(names, columns, unit);
        Ok(Some(Known::new(name, TIME, Some("temperature"), axes)))
    };
    let file = signs.file.to_lowercase();
    let may_be = ["sensor_gyro", "sensor_accel", "sensor_mag"].map(|topic| file.contains(topic));
    match may_be {
        [true, false, false] => known("PX4 sensor_gyro", GYROS, "radps"),
        [false, true, false] => known("PX4 sensor_accel", ["ax", "ay", "az"], "mps2"),
        [false, false, true] => Ok(None),
        _ if has_axes => known("PX4 sensor_gyro or sensor_accel", GYROS, "radps"),
        _ if signs.has(&["error_count"]) => Err(
            "PX4's sensor_gyro and sensor_accel have the same columns, and the name of the file \
             says neither: expected it to hold `sensor_gyro` or `sensor_accel`, or gyros as --axis \
             gx=x:radps --axis gy=y:radps --axis gz=z:radps, or accelerometers as --axis \
             ax=x:mps2 and so on"
                .to_owned(),
        ),
        _ => Ok(None),
    }
}

/// ArduPilot, as `mavlogdump` writes its message IMU.
fn ardupilot(signs: &Signs) -> Result<Option<Known>, String> {
    let columns = ["GyrX", "GyrY", "GyrZ"];
    if !signs.has(&["TimeUS"]) || !signs.has(&columns) {
        return Ok(None);
    }
    let temp = signs.first_of(&["T", "Temp"]);
    let known = Known::new(
        "ArduPilot IMU",
        "TimeUS:us",
        temp,
        axes(GYROS, columns, "radps"),
    );
    Ok(Some(Known {
        source: signs.first_of(&["I"]),
        warning: Some(
            "the autopilot's own temperature correction may be in it: expected a log with \
             INS_TCALn_ENABLE at 0",
        ),
        ..known
    }))
}

/// FlySight 2; its header was made from the lines `$COL,IMU` and `$UNIT,IMU`.
fn flysight(signs: &Signs) -> Result<Option<Known>, String> {
    if signs
        .header
        .first()
        .is_none_or(|first| first != FLYSIGHT_ROW)
    {
        return Ok(None);
    }
    let with_unit = |name: &str| {
        let start = format!("{name} [");
        signs
            .header
            .iter()
            .find(|column| column.starts_with(&start))
            .cloned()
    };
    let columns = ["wx", "wy", "wz"].map(with_unit);
    let [Some(x), Some(y), Some(z), Some(time)] = [
        columns[0].clone(),
        columns[1].clone(),
        columns[2].clone(),
        with_unit("time"),
    ] else {
        return Err(
            "FlySight 2: expected time, wx, wy and wz with their units in its lines \
                    $COL,IMU and $UNIT,IMU"
                .to_owned(),
        );
    };
    let mapping = Mapping {
        time: Some(time),
        temp: with_unit("temperature").into_iter().collect(),
        axis: vec![format!("gx={x}"), format!("gy={y}"), format!("gz={z}")],
        filter: vec![format!("{FLYSIGHT_ROW}={FLYSIGHT_ROW}")],
        ..Mapping::default()
    };
    Ok(Some(Known {
        name: "FlySight 2",
        mapping,
        source: None,
        warning: None,
    }))
}

/// What rows of the inertial sensor begin with, in a log of FlySight 2.
pub(crate) const FLYSIGHT_ROW: &str = "$IMU";

/// Text of Xsens MT Manager. Its time is a counter of 10 kHz, else the number of the packet.
fn xsens(signs: &Signs) -> Result<Option<Known>, String> {
    let columns = ["Gyr_X", "Gyr_Y", "Gyr_Z"];
    let lines = || {
        signs
            .preamble
            .iter()
            .map(|line| String::from_utf8_lossy(line))
    };
    if !signs.has(&columns) || !lines().any(|line| line.starts_with("//")) {
        return Ok(None);
    }
    let counter = signs
        .header
        .iter()
        .position(|column| column == "SampleTimeFine");
    let first = counter.and_then(|counter| signs.sample.first()?.get(counter));
    let has_counter = first.is_some_and(|cell| super::decimal::parse(cell).is_some());
    let rate = lines().find_map(|line| {
        let (what, rate) = line.split_once(':')?;
        let is_rate = what.contains("Update Rate") || what.contains("Sample rate");
        let rate: f64 = rate.trim().strip_suffix("Hz")?.trim().parse().ok()?;
        is_rate.then_some(rate)
    });
    let time = match rate {
        _ if has_counter => "SampleTimeFine:10000hz".to_owned(),
        Some(rate) if signs.has(&["PacketCounter"]) => format!("PacketCounter:{rate}hz"),
        _ => {
            return Err(
                "Xsens text without time: expected numbers in SampleTimeFine, or \
                        PacketCounter and a line `// Update Rate: 100.0Hz`"
                    .to_owned(),
            );
        }
    };
    let temp = signs.first_of(&["Temperature", "Temp"]);
    let axes = axes(GYROS, columns, "radps");
    Ok(Some(Known::new("Xsens text", &time, temp, axes)))
}

/// Kalibr and EuRoC; they have no temperature.
fn kalibr(signs: &Signs) -> Result<Option<Known>, String> {
    let known = |name, time, columns| {
        let axes = axes(GYROS, columns, "radps");
        Ok(Some(Known::new(name, time, None, axes)))
    };
    let euroc = [
        "w_RS_S_x [rad s^-1]",
        "w_RS_S_y [rad s^-1]",
        "w_RS_S_z [rad s^-1]",
    ];
    let omega = ["omega_x", "omega_y", "omega_z"];
    if signs.has(&euroc) && signs.has(&["timestamp [ns]"]) {
        return known("EuRoC", "timestamp [ns]:ns", euroc);
    }
    if signs.has(&omega) && signs.has(&["timestamp", "alpha_x", "alpha_y", "alpha_z"]) {
        return known("Kalibr", "timestamp:ns", omega);
    }
    Ok(None)
}
