//! A page as Chromium shows it, without a window.
//!
//! Spoken to over its DevTools protocol, which alone can set the width of a narrow screen, ask for
//! dark colours and tell what the page complained of.

mod session;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use data_encoding::BASE64;
use serde_json::{Value, json};
use tempco_qemu::{Workspace, ensure_program};

use session::Session;

/// What is measured in a page; see there.
const MEASURE: &str = include_str!("measure.js");

/// Chromium takes a second to start, and more on a machine that is busy.
const START: Duration = Duration::from_secs(60);

/// How a page is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// Width \[px\].
    pub width: u32,
    /// Whether the reader prefers dark colours.
    pub dark: bool,
}

/// What is wrong with a page; nothing, if it is as it should be.
pub type Findings = Vec<String>;

/// Chromium, until dropped.
pub struct Browser {
    process: Child,
    session: Session,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts Chromium, which is installed if it is missing and may be.
    ///
    /// # Panics
    /// If it cannot be installed or does not start.
    pub fn start() -> Self {
        let workspace = Workspace::find().expect("the sources");
        ensure_program(&workspace, "chromium", &["chromium"])
            .unwrap_or_else(|error| panic!("{error}"));
        let profile = tempfile::tempdir().expect("a folder for Chromium");
        let process = Command::new("chromium")
            .args(["--headless", "--disable-gpu", "--hide-scrollbars"])
            // As root, as in a container, Chromium starts only without a sandbox. It shows our own
            // pages alone.
            .args(["--no-sandbox", "--disable-dev-shm-usage"])
            .args(["--remote-debugging-port=0", "about:blank"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium");
        let address = address(profile.path());
        Self {
            process,
            session: Session::connect(&address),
            _profile: profile,
        }
    }

    /// Shows a page and says what is wrong with it: what it complained of, what it asked the network
    /// for, what `measure.js` finds; `figures` are the names of those it must have.
    ///
    /// # Panics
    /// If Chromium fails.
    pub fn findings(&mut self, page: &Path, screen: Screen, figures: &[String]) -> Findings {
        self.open(page, screen);
        let found = self.evaluate(&format!("({MEASURE})({})", json!(figures)));
        let found = found.as_array().expect("a list of findings").clone();
        let found = found.iter().filter_map(Value::as_str).map(str::to_owned);
        found.chain(self.complaints(page)).collect()
    }

    /// Shows a page.
    ///
    /// # Panics
    /// If Chromium fails.
    pub fn open(&mut self, page: &Path, screen: Screen) {
        self.look_on(screen);
        self.session.show(&url(page));
    }

    /// Shows the same page on another screen.
    ///
    /// # Panics
    /// If Chromium fails.
    pub fn look_on(&mut self, screen: Screen) {
        let scheme = if screen.dark { "dark" } else { "light" };
        self.session.call(
            "Emulation.setDeviceMetricsOverride",
            json!({"width": screen.width, "height": 900, "deviceScaleFactor": 1, "mobile": false}),
        );
        self.session.call(
            "Emulation.setEmulatedMedia",
            json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]}),
        );
    }

    /// What the page complained of since it was opened, and what it asked the network for.
    pub fn complaints(&self, page: &Path) -> Findings {
        self.session.complaints(&url(page))
    }

    /// Chooses files in the field for files that an expression gives.
    ///
    /// # Panics
    /// If there is no such field, or Chromium fails.
    pub fn choose(&mut self, field: &str, files: &[PathBuf]) {
        let answer = self
            .session
            .call("Runtime.evaluate", json!({"expression": field}));
        let parameters = json!({"files": files, "objectId": answer["result"]["objectId"]});
        self.session.call("DOM.setFileInputFiles", parameters);
    }

    /// Waits until an expression holds.
    ///
    /// # Panics
    /// If it does not within `limit`, or Chromium fails.
    pub fn wait_for(&mut self, expression: &str, limit: Duration) {
        let begun = Instant::now();
        while self.evaluate(expression) != true {
            assert!(
                begun.elapsed() < limit,
                "after {limit:?} not yet: {expression}"
            );
            sleep(Duration::from_millis(50));
        }
    }

    /// Lets the page write what is downloaded into a folder.
    ///
    /// # Panics
    /// If Chromium fails.
    pub fn download_to(&mut self, folder: &Path) {
        let parameters = json!({"behavior": "allow", "downloadPath": folder});
        self.session.call("Page.setDownloadBehavior", parameters);
    }

    /// Evaluates an expression in the page.
    ///
    /// # Panics
    /// If Chromium fails.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let parameters =
            json!({"expression": expression, "returnByValue": true, "userGesture": true});
        let mut answer = self.session.call("Runtime.evaluate", parameters);
        assert!(answer.get("exceptionDetails").is_none(), "{answer}");
        answer["result"]["value"].take()
    }

    /// Keeps a picture of the whole page.
    ///
    /// # Panics
    /// If Chromium fails, or the file cannot be written.
    pub fn screenshot(&mut self, to: &Path) {
        let parameters = json!({"format": "png", "captureBeyondViewport": true});
        let answer = self.session.call("Page.captureScreenshot", parameters);
        write_base64(to, &answer["data"]);
    }

    /// Prints the page to a PDF file, A4.
    ///
    /// # Panics
    /// If Chromium fails, or the file cannot be written.
    pub fn print(&mut self, to: &Path) {
        let parameters = json!({
            "preferCSSPageSize": true, "paperWidth": 8.27, "paperHeight": 11.69,
        });
        let answer = self.session.call("Page.printToPDF", parameters);
        write_base64(to, &answer["data"]);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It writes to its profile until it is gone, and the profile is removed next.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Where Chromium listens, as it notes in its profile once it does.
fn address(profile: &Path) -> String {
    let begun = Instant::now();
    let note: PathBuf = profile.join("DevToolsActivePort");
    loop {
        let text = std::fs::read_to_string(&note).unwrap_or_default();
        if let Some((port, path)) = text.split_once('\n')
            && !path.is_empty()
        {
            return format!("ws://127.0.0.1:{port}{path}");
        }
        assert!(begun.elapsed() < START, "Chromium does not start");
        sleep(Duration::from_millis(20));
    }
}

fn url(page: &Path) -> String {
    format!("file://{}", page.display())
}

fn write_base64(to: &Path, data: &Value) {
    let data = data.as_str().expect("a file in base 64");
    let bytes = BASE64.decode(data.as_bytes());
    std::fs::write(to, bytes.expect("base 64")).expect("a file");
}
