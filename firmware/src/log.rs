//! Logs of the application: by defmt with the feature `log`, and nothing at all without it.
//!
//! Without the feature the arguments are type-checked and not evaluated, so an image without logs
//! has neither their strings nor their code.

/// Logs something that the unit cannot go on with.
#[cfg(all(target_os = "none", feature = "log"))]
#[macro_export]
macro_rules! error {
    ($($arg:tt)*) => { ::defmt::error!($($arg)*) };
}

/// Logs something that the unit cannot go on with.
#[cfg(not(all(target_os = "none", feature = "log")))]
#[macro_export]
macro_rules! error {
    ($format:literal $(, $arg:expr)* $(,)?) => {{ $(let _ = || _ = &$arg;)* }};
}

/// Logs something that is wrong.
#[cfg(all(target_os = "none", feature = "log"))]
#[macro_export]
macro_rules! warn {
    ($($arg:tt)*) => { ::defmt::warn!($($arg)*) };
}

/// Logs something that is wrong.
#[cfg(not(all(target_os = "none", feature = "log")))]
#[macro_export]
macro_rules! warn {
    ($format:literal $(, $arg:expr)* $(,)?) => {{ $(let _ = || _ = &$arg;)* }};
}

/// Logs something worth knowing.
#[cfg(all(target_os = "none", feature = "log"))]
#[macro_export]
macro_rules! info {
    ($($arg:tt)*) => { ::defmt::info!($($arg)*) };
}

/// Logs something worth knowing.
#[cfg(not(all(target_os = "none", feature = "log")))]
#[macro_export]
macro_rules! info {
    ($format:literal $(, $arg:expr)* $(,)?) => {{ $(let _ = || _ = &$arg;)* }};
}

/// Logs something of use to whoever looks for a mistake.
#[cfg(all(target_os = "none", feature = "log"))]
#[macro_export]
macro_rules! debug {
    ($($arg:tt)*) => { ::defmt::debug!($($arg)*) };
}

/// Logs something of use to whoever looks for a mistake.
#[cfg(not(all(target_os = "none", feature = "log")))]
#[macro_export]
macro_rules! debug {
    ($format:literal $(, $arg:expr)* $(,)?) => {{ $(let _ = || _ = &$arg;)* }};
}
