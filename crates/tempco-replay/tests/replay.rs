//! The replay step against the core it wraps, and what the core puts out as records.

use tempco::{
    Compensator, Interval, Schedule, Status, Stream, Table, Terms, Thermal, ThermalSettings,
    Validity,
};
use tempco_replay::{Outcome, Replay, Sample};

const CELLS: [[Terms; 2]; 2] = [[Terms::new([1.0, 2.0, 0.5], [0.25, 0.125]); 2]; 2];

fn table(tau_s: f32) -> Table<'static, 2> {
    let thermal = Thermal::new(ThermalSettings {
        tau_s,
        ..ThermalSettings::DEFAULT
    });
    Table::new(thermal.unwrap(), -15.0, 80.0, &CELLS).unwrap()
}

fn sample(dt_s: f32, temps_c: [f32; 2]) -> Sample<2, 2> {
    Sample {
        update_s: Some(dt_s),
        temps_c,
        raw: [[1.0, 2.0], [3.0, 4.0]],
    }
}

#[test]
fn each_channel_is_a_compensator_of_its_own_started_once() {
    let tables = [table(60.0), table(10.0)];
    let mut replay = Replay::new(&tables);
    let mut units = [Compensator::new(&tables[0]), Compensator::new(&tables[1])];
    for i in 0..200_u8 {
        let temps_c = [20.0 + f32::from(i) * 0.01, 40.0 - f32::from(i) * 0.02];
        let dt_s = if i == 100 { 7.0 } else { 1.0 };
        let sample = sample(dt_s, temps_c);
        let outcome = replay.step(&sample);
        for channel in 0..2 {
            if i == 0 {
                units[channel].start(temps_c[channel]);
            }
            let interval = Interval::new(tables[channel].thermal(), dt_s);
            let expected = units[channel].step(&interval, temps_c[channel], sample.raw[channel]);
            let got = outcome.channels[channel];
            assert_eq!(got.effective_c, expected.point.effective_c);
            assert_eq!(got.rate_c_per_min, expected.point.rate_c_per_min);
            assert_eq!(got.flags(), expected.status);
            assert_eq!(got.bias, expected.bias);
            assert_eq!(got.compensated, expected.compensated);
        }
        // The longest interval is 5 s for a time constant of 10 s, and 30 s for one of 60 s.
        let long = outcome
            .channels
            .map(|c| c.flags().contains(Status::INTERVAL_INVALID));
        assert_eq!(long, [false, i == 100]);
    }
}

/// Five rows to an update, as of a log of 50 Hz.
#[test]
fn rows_between_updates_keep_the_last_one_and_have_flags_of_their_own() {
    let tables = [table(60.0), table(10.0)];
    let mut thinned = Replay::new(&tables);
    let mut updates = Replay::new(&tables);
    let mut last = None;
    for row in 0..500_u16 {
        // A first row is an update whatever it says.
        let is_update = row % 5 == 0;
        let temps_c = [20.0 + f32::from(row) * 0.01, f32::from(row)];
        let mut now = sample(0.1, temps_c);
        now.raw[0][1] = if row == 7 { f32::NAN } else { f32::from(row) };
        now.update_s = now.update_s.filter(|_| is_update && row > 0);
        let found = thinned.step(&now);
        if is_update {
            let dt_s = if row == 0 { 0.0 } else { 0.1 };
            let expected = updates.step(&Sample {
                update_s: Some(dt_s),
                ..now
            });
            assert_eq!(found, expected, "{row}");
            last = Some(expected);
            continue;
        }
        for (channel, (found, last)) in found
            .channels
            .iter()
            .zip(last.unwrap().channels)
            .enumerate()
        {
            assert_eq!(
                (found.effective_c, found.bias),
                (last.effective_c, last.bias)
            );
            assert_eq!(found.rate_c_per_min, last.rate_c_per_min);
            let is_bad = row == 7 && channel == 0;
            let raw = if is_bad {
                Status::RAW_INVALID
            } else {
                Status::OK
            };
            assert_eq!(found.flags(), last.flags() | raw, "{row}");
            assert_eq!(found.compensated[0], now.raw[channel][0] - last.bias[0]);
        }
    }
    let (thinned, updates) = (thinned.summary(), updates.summary());
    assert_eq!((thinned.samples, updates.samples), (500, 100));
    assert_eq!(thinned.rejected, updates.rejected);
}

#[test]
fn summary_counts_what_happened() {
    let tables = [table(60.0), table(60.0)];
    let mut replay = Replay::new(&tables);
    assert_eq!(replay.summary().samples, 0);
    assert_eq!(replay.summary().worst(), Validity::Valid);

    // Both channels settle for 180 s after their start.
    for _ in 0..300 {
        replay.step(&sample(1.0, [25.0, 25.0]));
    }
    let settled = replay.summary();
    assert_eq!(
        (settled.samples, settled.rejected, settled.restarts),
        (300, 0, 2)
    );
    assert!((179..=181).contains(&settled.not_valid), "{settled:?}");
    assert_eq!(settled.seen, Status::SETTLING);
    assert_eq!(settled.worst(), Validity::Degraded);

    replay.step(&sample(1.0, [f32::NAN, 25.0]));
    let mut bad_raw = sample(1.0, [25.0, 25.0]);
    bad_raw.raw[1][0] = f32::NEG_INFINITY;
    replay.step(&bad_raw);
    let end = replay.summary();
    assert_eq!((end.samples, end.rejected), (302, 1));
    assert_eq!(end.not_valid, settled.not_valid + 2);
    assert!(
        end.seen
            .contains(Status::TEMPERATURE_INVALID | Status::RAW_INVALID)
    );
    assert_eq!(end.worst(), Validity::Invalid);
}

#[test]
fn every_nan_comes_out_as_the_same_one() {
    let tables = [table(60.0); 2];
    let mut replay = Replay::new(&tables);
    for bits in [0x7fc0_0000, 0xffc0_0000, 0x7f80_0001, 0xffff_ffff] {
        let mut bad = sample(1.0, [25.0, 25.0]);
        bad.raw[0] = [f32::from_bits(bits), f32::INFINITY];
        let channel = replay.step(&bad).channels[0];
        assert_eq!(channel.compensated[0].to_bits(), 0x7fc0_0000);
        assert_eq!(channel.compensated[1], f32::INFINITY);
        assert!(channel.bias.iter().all(|bias| bias.is_finite()));
    }
}

#[test]
fn what_a_stream_puts_out_becomes_an_outcome() {
    let tables = [table(60.0); 2];
    let schedule = Schedule {
        sample_rate_hz: 2000.0,
        samples_per_update: 200,
    };
    let mut stream = Stream::new(&tables, &schedule);
    stream.temperatures(&[25.0, 40.0]);
    let raw = [[f32::from_bits(0xffc0_0001), 2.0], [3.0, f32::INFINITY]];
    let outputs = stream.sample(&raw);
    let outcome = Outcome::from(outputs);
    for (channel, output) in outcome.channels.iter().zip(&outputs) {
        assert_eq!(channel.effective_c, output.point.effective_c);
        assert_eq!(channel.rate_c_per_min, output.point.rate_c_per_min);
        assert_eq!(channel.flags(), output.status);
        assert!(channel.flags().contains(Status::RAW_INVALID));
        assert_eq!(channel.bias, output.bias);
        assert_eq!(channel.compensated[1], output.compensated[1]);
    }
    let [first, second] = outcome.channels.map(|channel| channel.compensated[0]);
    assert_eq!(first.to_bits(), 0x7fc0_0000);
    assert_eq!(second, outputs[1].compensated[0]);
}
