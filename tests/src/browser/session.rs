//! One page of a running Chromium, by messages over a WebSocket.

use std::net::TcpStream;
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

/// No single answer takes this long, unless Chromium hangs.
const PATIENCE: Duration = Duration::from_secs(60);

pub(super) struct Session {
    socket: WebSocket<TcpStream>,
    /// Of the page; calls before it is known are to the browser.
    id: Option<String>,
    calls: u64,
    /// What happened besides answers, since the page was opened.
    events: Vec<Value>,
}

impl Session {
    /// Connects to the browser and opens a page.
    pub(super) fn connect(address: &str) -> Self {
        let host = address
            .trim_start_matches("ws://")
            .split('/')
            .next()
            .expect("a host");
        let stream = TcpStream::connect(host).expect("a connection to Chromium");
        stream
            .set_read_timeout(Some(PATIENCE))
            .expect("a time limit");
        let (socket, _) = tungstenite::client(address, stream).expect("a WebSocket");
        let mut session = Self {
            socket,
            id: None,
            calls: 0,
            events: Vec::new(),
        };
        let target = session.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let attached = session.call("Target.attachToTarget", target);
        session.id = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            session.call(&format!("{domain}.enable"), json!({}));
        }
        session
    }

    /// Calls a method and waits for its answer.
    pub(super) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut call = json!({"id": self.calls, "method": method, "params": parameters});
        if let Some(id) = &self.id {
            call["sessionId"] = json!(id);
        }
        let call = Message::text(call.to_string());
        self.socket.send(call).expect("Chromium listens");
        loop {
            let mut message = self.read();
            if message["id"] == self.calls {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].take();
            }
            self.events.push(message);
        }
    }

    /// Loads a page and waits until all of it is there.
    pub(super) fn show(&mut self, url: &str) {
        self.events.clear();
        self.call("Page.navigate", json!({"url": url}));
        while !self
            .events
            .iter()
            .any(|e| e["method"] == "Page.loadEventFired")
        {
            let event = self.read();
            self.events.push(event);
        }
    }

    fn read(&mut self) -> Value {
        let message = self.socket.read().expect("Chromium answers");
        match message {
            Message::Text(text) => serde_json::from_str(&text).expect("JSON"),
            _ => Value::Null,
        }
    }

    /// What the page at `url` printed, threw, or asked for besides itself.
    pub(super) fn complaints(&self, url: &str) -> Vec<String> {
        let complaint = |event: &Value| {
            let parameters = &event["params"];
            match event["method"].as_str()? {
                "Runtime.consoleAPICalled" => Some(format!("console: {}", parameters["args"])),
                "Runtime.exceptionThrown" => Some(format!("thrown: {parameters}")),
                "Log.entryAdded" => Some(format!("logged: {}", parameters["entry"]["text"])),
                "Network.requestWillBeSent" if parameters["request"]["url"] != url => {
                    Some(format!("asked for {}", parameters["request"]["url"]))
                }
                _ => None,
            }
        };
        self.events.iter().filter_map(complaint).collect()
    }
}
