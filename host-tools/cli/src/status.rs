//! Status flags in words.

use tempco::Status;

/// The names of the flags that are set.
pub(crate) fn status_names(status: Status) -> Vec<&'static str> {
    let flags = Status::NAMES.iter();
    let set = flags.filter(|(flag, _)| status.contains(*flag));
    set.map(|(_, name)| *name).collect()
}

/// The names joined by `+`; `ok` where none is set.
pub(crate) fn status_text(status: Status) -> String {
    let text = status_names(status).join("+");
    if text.is_empty() {
        "ok".to_owned()
    } else {
        text
    }
}
