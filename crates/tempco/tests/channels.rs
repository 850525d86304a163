//! The stream of channels against the compensators it is made of.

use tempco::{
    Interval, Schedule, Status, Stream, Table, Terms, Thermal, ThermalSettings, TwoRateCompensator,
};

const CELLS: [[Terms; 2]; 2] = [[Terms::new([1.0, 2.0, 0.5], [0.25, 0.125]); 2]; 2];

fn table(tau_s: f32) -> Table<'static, 2> {
    let thermal = Thermal::new(ThermalSettings {
        tau_s,
        ..ThermalSettings::DEFAULT
    });
    Table::new(thermal.unwrap(), -15.0, 80.0, &CELLS).unwrap()
}

#[test]
fn a_stream_is_a_two_rate_compensator_per_channel() {
    let tables = [table(60.0), table(10.0)];
    let schedule = Schedule {
        sample_rate_hz: 2000.0,
        samples_per_update: 200,
    };
    let mut stream = Stream::new(&tables, &schedule);
    let mut units = tables.each_ref().map(|t| TwoRateCompensator::new(t, 200));
    for i in 0..2000_u16 {
        if i % 200 == 100 {
            let temp_c = 20.0 + f32::from(i) * 0.01;
            for (unit, table) in units.iter_mut().zip(&tables) {
                if i == 100 {
                    unit.start(temp_c);
                }
                unit.update(&Interval::new(table.thermal(), 0.1), temp_c);
            }
            stream.temperatures(&[temp_c; 2]);
        }
        let raw = [[1.0, f32::NAN], [3.0, f32::from(i)]];
        let outputs = stream.sample(&raw);
        for channel in 0..2 {
            let expected = units[channel].compensate(raw[channel]);
            let got = outputs[channel];
            assert_eq!(got.point, units[channel].point());
            assert_eq!(got.bias, units[channel].bias());
            assert_eq!(got.compensated[1].is_nan(), channel == 0);
            assert_eq!(got.compensated[0], expected[0]);
            assert_eq!(got.status.contains(Status::RAW_INVALID), channel == 0);
            assert_eq!(got.status.contains(Status::TEMPERATURE_LOST), i < 100);
        }
    }
}
