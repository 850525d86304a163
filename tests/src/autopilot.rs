//! Logs of autopilots with several sensors, written by their public formats.

/// A row: the sensor, time \[us\], rates \[rad/s\] and temperature \[degC\].
pub type Row = (u8, u64, [f32; 3], f32);

/// A file of PX4: ULog with two instances of `sensor_gyro`.
pub fn ulog(rows: &[Row]) -> Vec<u8> {
    let mut file = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let mut record = |kind: u8, content: &[u8]| {
        let size = u16::try_from(content.len()).expect("a short record");
        file.extend(size.to_le_bytes());
        file.push(kind);
        file.extend(content);
    };
    record(b'B', &[0; 40]);
    record(
        b'F',
        b"sensor_gyro:uint64_t timestamp;uint32_t device_id;float x;float y;float z;float temperature;",
    );
    for sensor in [0, 1] {
        record(b'A', &[&[sensor, sensor, 0], &b"sensor_gyro"[..]].concat());
    }
    for &(sensor, us, rates, temp_c) in rows {
        let mut row = vec![sensor, 0];
        row.extend(us.to_le_bytes());
        row.extend(7_u32.to_le_bytes());
        row.extend(rates.map(f32::to_le_bytes).as_flattened());
        row.extend(temp_c.to_le_bytes());
        record(b'D', &row);
    }
    file
}

/// A file of ArduPilot: DataFlash with IMUs, and `INS_TCAL2_ENABLE`.
pub fn dataflash(rows: &[Row], second_is_corrected: bool) -> Vec<u8> {
    let mut file = Vec::new();
    for (kind, size, name, types, labels) in [
        (0x80, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        (2, 31, "PARM", "QNf", "TimeUS,Name,Value"),
        (3, 28, "IMU", "QBffff", "TimeUS,I,GyrX,GyrY,GyrZ,T"),
    ] {
        file.extend([0xa3, 0x95, 0x80, kind, size]);
        for (text, length) in [(name, 4), (types, 16), (labels, 64)] {
            file.extend(text.as_bytes());
            file.resize(file.len() + length - text.len(), 0);
        }
    }
    file.extend([0xa3, 0x95, 2, 1, 0, 0, 0, 0, 0, 0, 0]);
    file.extend(b"INS_TCAL2_ENABLE");
    file.extend(f32::from(u8::from(second_is_corrected)).to_le_bytes());
    for &(sensor, us, rates, temp_c) in rows {
        file.extend([0xa3, 0x95, 3]);
        file.extend(us.to_le_bytes());
        file.push(sensor);
        file.extend(rates.map(f32::to_le_bytes).as_flattened());
        file.extend(temp_c.to_le_bytes());
    }
    file
}
