//! What is read of a header.

use super::axis_columns::AxisColumn;
use super::columns::Columns;
use super::known::Signs;
use super::mapping::Mapping;
use super::names;
use super::temp_columns::TempSource;
use super::time::TimeUnit;
use crate::unit::ColumnUnit;

fn find_with(header: &str, mapping: &Mapping) -> Result<Columns, String> {
    let header: Vec<String> = header.split(',').map(str::to_owned).collect();
    let signs = Signs {
        header: &header,
        file: "log.csv",
        preamble: &[],
        sample: &[],
        has_instances: false,
    };
    Columns::find(&signs, mapping, &[], None)
}

fn find(header: &str) -> Result<Columns, String> {
    find_with(header, &Mapping::default())
}

fn axis_names(columns: &Columns) -> Vec<Vec<&str>> {
    let name = |axis: &AxisColumn| axis.name.clone().leak() as &str;
    columns
        .channels
        .iter()
        .map(|channel| channel.axes.iter().map(name).collect())
        .collect()
}

#[test]
fn names_with_units_are_recognised_and_the_rest_is_ignored() {
    let columns = find("time_s,temp_c,gx_dps,gyro_y_pulses,az_mps2,baro_temp_c,mx_cnt,note");
    let columns = columns.unwrap();
    assert_eq!(axis_names(&columns), [["gx", "gyro_y", "az"]]);
    assert_eq!(columns.channels[0].axes[1].unit, ColumnUnit::Pulses);
    assert_eq!(columns.ignored, ["baro_temp_c", "mx_cnt", "note"]);
}

#[test]
fn temperatures_per_axis_go_to_their_axes() {
    let columns = find("time_s,temp_x_c,temp_y_c,gx_dps,gy_dps,ax_g,ay_g").unwrap();
    assert_eq!(axis_names(&columns), [["gx", "ax"], ["gy", "ay"]]);
    assert_eq!(columns.channels[1].temp, TempSource::Column(2));
}

#[test]
fn what_is_unclear_is_refused_with_what_was_expected() {
    for (header, part) in [
        ("time_min,temp_c,x_dps", "`time_min` is not in seconds"),
        (
            "t,temp_c,x_dps",
            "`t` has no unit: expected --time t:s, :ms, :us",
        ),
        (
            "Time,temp_c,x_dps",
            "`Time` has no unit: expected --time Time:s",
        ),
        (
            "Time [ms],time_us,temp_c,x_dps",
            "`Time [ms]`, `time_us`: choose one by --time",
        ),
        (
            "time_s,Temp,x_dps",
            "`Temp` has no unit: expected --temp Temp:degc, :degf or :k",
        ),
        (
            "time_s,temp_c,Gyro X [rpm]",
            "`Gyro X [rpm]` has the unknown unit `rpm`",
        ),
        ("time_s,temp_c,GyX,GyY", "--axis \"gyx=GyX:UNIT\""),
        ("time_s,temp_c,Weight [g]", "no axis column"),
        (
            "time_s,temp_c,Gyro X [dps],gyro_x (dps)",
            "two axes are named `gyro_x`",
        ),
        ("time_s;temp_c;x_dps", "columns must be separated by"),
        ("time_s,x_dps", "no temperature column"),
        ("time_s,temp_r,x_dps", "`temp_r` is not in degC"),
        ("time_s,temp_c,x_rpm", "unknown unit `rpm`"),
        ("time_s,temp_c,gx_dps,gy_dps,gz", "`gz` has no unit"),
        ("time_s,temp_c,gyro_x", "`gyro_x` has no unit"),
        ("time_s,temp_c,mx_cnt", "no axis column"),
        (
            "time_s,temp_c,temp_c,x_dps",
            "two columns are named `temp_c`",
        ),
        ("time_s,temp_c,temp_case_c,x_dps", "2 temperature columns"),
        ("time_s,temp1_c,temp2_c,x_dps", "2 temperature columns"),
        ("time_s,temp_x_c,temp_y_c,x_dps", "same number of axes"),
        (
            "time_s,temp_c,a_g,b_g,c_g,d_g,e_g,f_g,h_g",
            "7 axis columns",
        ),
    ] {
        let error = find(header).unwrap_err();
        assert!(error.contains(part), "{header}: {error}");
    }
}

#[test]
fn units_in_names_are_read() {
    let columns = find("Zeit [s],Temperatur [\u{b0}C],Gyro X [\u{b0}/s],Gyro Y (deg/s)").unwrap();
    assert_eq!(axis_names(&columns), [["gyro_x", "gyro_y"]]);
    let mapping = columns.reading.mapping.unwrap();
    assert_eq!(mapping.time.as_deref(), Some("Zeit [s]:s"));
    assert_eq!(mapping.temp, ["Temperatur [\u{b0}C]:degc"]);
    assert_eq!(mapping.axis[0], "gyro_x=Gyro X [\u{b0}/s]");
    let columns = find("millis,temp_k,x_dps").unwrap();
    assert_eq!(columns.time_unit, TimeUnit::Ms);
    assert_eq!(columns.channels[0].to_deg_c, names::TempUnit::K.to_deg_c());
    assert!(
        find("time_s,temp_c,x_dps,Gyro X [rpm],T [K]")
            .unwrap()
            .reading
            .is_plain()
    );
}

#[test]
fn temperatures_by_the_start_of_names_are_channels() {
    let columns = find("time_s,imu0_temp_c,imu0_gx_dps,imu1_temp_c,imu1_gx_dps").unwrap();
    assert_eq!(axis_names(&columns), [["imu0_gx"], ["imu1_gx"]]);
    let mapping = columns.reading.mapping.unwrap();
    assert_eq!(
        mapping.temp,
        ["imu0_gx=imu0_temp_c:degc", "imu1_gx=imu1_temp_c:degc"]
    );
    let header = "time_s,imu0_temp_c,imu0_gx_dps,imu1_temp_c,imu1_gx_dps";
    let again = find_with(header, &mapping).unwrap();
    assert_eq!(again.channels, columns.channels);
}

#[test]
fn a_mapping_overrules_the_names() {
    let mapping = Mapping {
        time: Some("t".to_owned()),
        temp: vec!["x=T2".to_owned(), "y=T1".to_owned()],
        axis: vec!["x=wx:dps".to_owned(), "y=wy:dps".to_owned()],
        ..Mapping::default()
    };
    let columns = find_with("t,T1,T2,wx,wy", &mapping).unwrap();
    let temp = columns.channels[0].temp;
    assert_eq!((columns.time, temp), (0, TempSource::Column(2)));
    assert_eq!(axis_names(&columns), [["x"], ["y"]]);
    let missing = Mapping {
        time: Some("time".to_owned()),
        ..mapping
    };
    let error = find_with("t,T1,T2,wx,wy", &missing).unwrap_err();
    assert!(error.contains("no column `time`"), "{error}");
}
