//! A unit that notes what it carried out, and a wire to it.
#![allow(dead_code, reason = "each test program uses its share")]

use tempco_link::{
    Client, Event, Frame, Handler, MAX_FRAME, Refusal, Request, Response, Server, VERSION,
};

/// An upload as `tempco-store` takes it, and commands that must not be carried out twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Unit {
    /// Requests that were carried out.
    pub(crate) done: Vec<String>,
    pub(crate) image: Vec<u8>,
    pub(crate) committed: Vec<u8>,
}

impl Handler for Unit {
    fn handle(&mut self, request: Request<'_>) -> Response<'_> {
        self.done.push(format!("{request:?}"));
        match request {
            Request::UploadBegin { .. } => {
                self.image.clear();
                Response::Expected { offset: 0 }
            }
            Request::UploadChunk { offset, bytes } => {
                if offset as usize == self.image.len() {
                    self.image.extend_from_slice(bytes);
                }
                Response::Expected {
                    offset: self.image.len() as u32,
                }
            }
            Request::UploadCommit { len, crc } => {
                let good = len as usize == self.image.len()
                    && crc == tempco_image::CRC.checksum(&self.image);
                if !good {
                    return Response::Refused(Refusal::Image);
                }
                self.committed.clone_from(&self.image);
                Response::Done
            }
            Request::Download { offset, len, .. } => {
                let from = self.committed.len().min(offset as usize);
                let to = self.committed.len().min(from + usize::from(len));
                Response::Chunk {
                    offset,
                    bytes: &self.committed[from..to],
                }
            }
            _ => Response::Done,
        }
    }
}

/// What the server answers to bytes.
pub(crate) fn feed(server: &mut Server, unit: &mut Unit, bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes
        .iter()
        .filter_map(|byte| server.receive(*byte, unit).map(<[u8]>::to_vec))
        .collect()
}

/// Events that a client sees in bytes, as text.
pub(crate) fn events(client: &mut Client, bytes: &[u8]) -> Vec<String> {
    let events = bytes.iter().filter_map(|byte| {
        let event = client.receive(*byte)?;
        Some(match event {
            Event::Answer(response) => format!("{response:?}"),
            Event::Telemetry(telemetry) => format!("telemetry {}", telemetry.index),
        })
    });
    events.collect()
}

/// A client with an open session.
pub(crate) fn connected(server: &mut Server, unit: &mut Unit, nonce: u32) -> Client {
    let mut client = Client::new();
    let hello = client.hello(nonce).unwrap().to_vec();
    let answers = feed(server, unit, &hello).concat();
    assert_eq!(events(&mut client, &answers).len(), 1, "an answer to hello");
    client
}

/// A request over a good wire, and its answer as text.
pub(crate) fn ask(
    client: &mut Client,
    server: &mut Server,
    unit: &mut Unit,
    request: &Request,
) -> String {
    let wire = client.request(request).unwrap().to_vec();
    let answers = feed(server, unit, &wire).concat();
    events(client, &answers).pop().expect("an answer")
}

pub(crate) fn wire(session: u32, sequence: u16, message: &Request) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME];
    let frame = Frame {
        session,
        sequence,
        message,
    };
    let len = frame.encode(&mut bytes).unwrap();
    bytes[..len].to_vec()
}

pub(crate) fn hello(nonce: u32) -> Request<'static> {
    Request::Hello {
        major: VERSION.0,
        minor: VERSION.1,
        nonce,
    }
}
