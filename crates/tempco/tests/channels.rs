//! The channels against the halves they are made of.

use tempco::{
    Corrector, Interval, RampBuffer, Schedule, Status, Stream, Table, Terms, Thermal,
    ThermalChannels, ThermalHalf, ThermalSettings,
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
fn a_stream_is_both_halves_of_each_channel() {
    let tables = [table(60.0), table(10.0)];
    let schedule = Schedule {
        sample_rate_hz: 2000.0,
        samples_per_update: 200,
    };
    let mut stream = Stream::new(&tables, &schedule);
    let mut halves = tables.each_ref().map(|table| ThermalHalf::new(table, 200));
    let ramps = [RampBuffer::new(), RampBuffer::new()];
    for (buffer, table) in ramps.iter().zip(&tables) {
        buffer.publish(&ThermalHalf::constant(table));
    }
    for i in 0..2000_u16 {
        if i % 200 == 100 {
            let temp_c = 20.0 + f32::from(i) * 0.01;
            for (channel, half) in halves.iter_mut().enumerate() {
                if i == 100 {
                    half.start(temp_c);
                }
                let interval = Interval::new(tables[channel].thermal(), 0.1);
                ramps[channel].publish(&half.update(&interval, temp_c));
            }
            stream.temperatures(&[temp_c; 2]);
        }
        let raw = [[1.0, f32::NAN], [3.0, f32::from(i)]];
        let outputs = stream.sample(&raw);
        for channel in 0..2 {
            let mut corrector = Corrector::new(&ramps[channel]);
            let expected = corrector.correct(raw[channel]);
            let got = outputs[channel];
            assert_eq!(got.point, halves[channel].point());
            assert_eq!(got.compensated[1].is_nan(), channel == 0);
            assert_eq!(got.compensated[0], expected[0]);
            assert_eq!(got.compensated[0], raw[channel][0] - got.bias[0]);
            assert_eq!(
                got.status,
                corrector.status() | Status::of_raw(&raw[channel])
            );
            assert_eq!(got.status.contains(Status::TEMPERATURE_LOST), i < 100);
            assert!(!got.status.contains(Status::INTERVAL_INVALID));
        }
    }
}

/// A copy of the tables in the middle of a run changes no bit, and tables that are taken over count.
#[test]
fn thermal_halves_go_on_with_copies_of_their_tables() {
    let (tables, copies, others) = ([table(60.0)], [table(60.0)], [table(10.0)]);
    let mut stays = ThermalChannels::new(&tables, 200);
    let mut moves = stays.clone();
    let temp_c = |i: u8| 20.0 + f32::from(i) * 0.1;
    for i in 0..100 {
        if i == 50 {
            moves.move_to(&copies);
        }
        let ramps = stays.update(0.1, &[temp_c(i)]);
        assert_eq!(moves.update(0.1, &[temp_c(i)]), ramps, "{i}");
    }
    moves.move_to(&others);
    let _ = (stays.update(0.1, &[40.0]), moves.update(0.1, &[40.0]));
    assert_ne!(stays.points(), moves.points());
}

#[test]
fn a_step_of_time_is_what_it_is_said_to_be() {
    let tables = [table(60.0)];
    let mut one = ThermalChannels::new(&tables, 200);
    let mut half = ThermalHalf::new(&tables[0], 200);
    half.start(25.0);
    for (dt_s, temp_c) in [
        (0.1, 25.0),
        (0.1, 25.1),
        (1.7, 26.0),
        (40.0, 27.0),
        (0.1, 90.0),
    ] {
        let interval = Interval::new(tables[0].thermal(), dt_s);
        assert_eq!(
            one.update(dt_s, &[temp_c]),
            [half.update(&interval, temp_c)]
        );
    }
    assert_eq!(one.points(), [half.point()]);
    assert_eq!(one.rejected(), 1);
}

#[test]
fn rejections_of_all_channels_are_counted_together() {
    let tables = [table(60.0), table(60.0)];
    let mut channels = ThermalChannels::new(&tables, 200);
    channels.update(0.1, &[25.0; 2]);
    assert_eq!(channels.rejected(), 0);
    channels.update(0.1, &[90.0, 25.0]);
    channels.update(0.1, &[90.0; 2]);
    assert_eq!(channels.rejected(), 3);
}
