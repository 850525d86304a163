//! What column names say.

/// Words for the time, in lower case and without blanks.
const TIME_NAMES: [&str; 12] = [
    "elapsed",
    "elapsedtime",
    "micros",
    "millis",
    "t",
    "tiempo",
    "time",
    "timestamp",
    "uptime",
    "zeit",
    "zeitstempel",
    "sampletimefine",
];

/// Whether a name may be the time's.
pub(super) fn may_be_time(name: &[u8]) -> bool {
    let name = String::from_utf8_lossy(name).to_lowercase();
    let word = name.split([' ', '_', '[', '(']).next().unwrap_or_default();
    TIME_NAMES.contains(&word) || name.starts_with("time")
}
