//! A machine that runs an image in the background, with a line to its first UART.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};
use std::{env, fs};

use serde_json::json;
use tempfile::TempDir;

use crate::log::Messages;
use crate::qmp::Qmp;
use crate::{Board, Error, gdb};

/// QEMU is up long before.
const START_LIMIT: Duration = Duration::from_secs(20);

/// How a machine is run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineOptions {
    /// How time passes.
    pub time: MachineTime,
    /// A file that stands for the memory that the machine has by option (16 MiB at 0x21000000 on
    /// the MPS2 boards). It outlives the machine, as flash does, and others may read and write it
    /// while the machine runs.
    pub memory: Option<PathBuf>,
    /// Further arguments of QEMU.
    pub extra: Vec<String>,
}

/// How time passes in a machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MachineTime {
    /// As on the host.
    #[default]
    Host,
    /// By 2^n ns per instruction, and as on the host while the processor sleeps: a busy host slows
    /// the program down without taking time from it.
    Counted {
        /// n.
        shift: u8,
    },
    /// By 2^n ns per instruction, and at once to the next event while the processor sleeps: nothing
    /// in it depends on the host's time any more. A processor that sleeps misses every other event
    /// of a timer; the application stays awake on emulated boards.
    Unbound {
        /// n.
        shift: u8,
    },
}

/// A machine that runs, until it is dropped.
pub struct Machine {
    process: Arc<Running>,
    qmp: Qmp,
    messages: Messages,
    stdout: Collected,
    /// For the sockets, and for what QEMU writes.
    folder: PathBuf,
}

impl Drop for Machine {
    fn drop(&mut self) {
        locked(&self.process).take();
    }
}

impl Machine {
    /// Starts a machine with an image. It is running when this returns, and the socket of its
    /// first UART takes connections; the image may still be booting.
    ///
    /// # Errors
    /// There is no QEMU, or it refuses the image or an argument.
    pub fn start(elf: &Path, board: Board, options: &MachineOptions) -> Result<Self, Error> {
        let elf = elf.canonicalize().map_err(Error::file(elf))?;
        let messages = Messages::of(&elf, &fs::read(&elf).map_err(Error::file(&elf))?)?;
        let folder = tempfile::tempdir().map_err(Error::file(&env::temp_dir()))?;
        let path = folder.path().to_owned();
        let mut command = qemu(&elf, board, &path, options);
        let child = command.spawn().map_err(|cause| Error::Start {
            program: "qemu-system-arm".to_owned(),
            cause,
        })?;
        let mut process = Process { child, folder };
        let stdout = Collected::of(process.child.stdout.take());
        let stderr = Collected::of(process.child.stderr.take());
        let qmp = control(
            &mut process.child,
            &process.folder.path().join("qmp"),
            &stderr,
        )?;
        Ok(Self {
            process: register(process),
            qmp,
            messages,
            stdout,
            folder: path,
        })
    }

    /// The socket of the first UART.
    pub fn link(&self) -> PathBuf {
        self.folder.join("link")
    }

    /// Lets time stand still.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn pause(&mut self) -> Result<(), Error> {
        self.qmp.command("stop", json!({})).map(drop)
    }

    /// Lets time go on.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn go_on(&mut self) -> Result<(), Error> {
        self.qmp.command("cont", json!({})).map(drop)
    }

    /// What the image logged so far, a message each; nothing without the feature `messages`.
    pub fn log(&self) -> Vec<String> {
        self.messages.lines(&self.stdout.so_far())
    }

    /// Resets the machine, as a reset pin does; what is in its memory stays.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.qmp.command("system_reset", json!({})).map(drop)
    }

    /// Reads physical memory.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn read_memory(&mut self, address: u32, len: usize) -> Result<Vec<u8>, Error> {
        let path = self.folder.join("memory");
        let arguments = json!({"val": address, "size": len, "filename": path});
        self.qmp.command("pmemsave", arguments)?;
        fs::read(&path).map_err(Error::file(&path))
    }

    /// Writes physical memory, as radiation may: the image gets no notice.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn write_memory(&mut self, address: u32, bytes: &[u8]) -> Result<(), Error> {
        let socket = self.folder.join("gdb");
        if !socket.exists() {
            let path = escaped(&socket);
            self.monitor(&format!("gdbserver unix:{path},server=on,wait=off"))?;
        }
        let status = self.qmp.command("query-status", json!({}))?;
        gdb::write_memory(&socket, address, bytes)?;
        if status["running"] == true {
            self.go_on()?;
        }
        Ok(())
    }

    /// Carries out a command of QEMU's monitor for people, such as `info registers`, and returns
    /// what it prints.
    ///
    /// # Errors
    /// QEMU has ended.
    pub fn monitor(&mut self, command: &str) -> Result<String, Error> {
        let arguments = json!({"command-line": command});
        let printed = self.qmp.command("human-monitor-command", arguments)?;
        Ok(printed.as_str().unwrap_or_default().to_owned())
    }
}

/// The process of a machine, with its sockets.
struct Process {
    child: Child,
    folder: TempDir,
}

/// As by a cut of the supply: the image gets no notice.
impl Drop for Process {
    fn drop(&mut self) {
        // Both fail only where it has ended by itself.
        _ = self.child.kill();
        _ = self.child.wait();
    }
}

/// A process, until it is ended.
type Running = Mutex<Option<Process>>;

/// Every process that may still run.
static RUNNING: Mutex<Vec<Weak<Running>>> = Mutex::new(Vec::new());

fn register(process: Process) -> Arc<Running> {
    let process = Arc::new(Mutex::new(Some(process)));
    let mut running = locked(&RUNNING);
    running.retain(|process| process.strong_count() > 0);
    running.push(Arc::downgrade(&process));
    process
}

/// Ends all machines of this process, for a program that ends at once.
pub fn end_all_machines() {
    for process in locked(&RUNNING).iter().filter_map(Weak::upgrade) {
        locked(&process).take();
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn qemu(elf: &Path, board: Board, folder: &Path, options: &MachineOptions) -> Command {
    let mut machine = board.machine().to_owned();
    let mut command = Command::new("qemu-system-arm");
    if let Some(memory) = &options.memory {
        machine += ",memory-backend=kept";
        let path = escaped(memory);
        let backend = format!("memory-backend-file,id=kept,size=16M,share=on,mem-path={path}");
        command.args(["-object", &backend]);
    }
    let socket = |name: &str| format!("path={},server=on,wait=off", escaped(&folder.join(name)));
    command
        .args(["-machine", &machine, "-display", "none", "-monitor", "none"])
        .args(["-chardev", &format!("socket,id=link,{}", socket("link"))])
        .args(["-serial", "chardev:link"])
        .args(["-chardev", &format!("socket,id=qmp,{}", socket("qmp"))])
        .args(["-mon", "chardev=qmp,mode=control"])
        .args(["-semihosting-config", "enable=on,target=native,arg=tempco"])
        .arg("-kernel")
        .arg(elf)
        .args(&options.extra)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let icount = match options.time {
        MachineTime::Host => None,
        MachineTime::Counted { shift } => Some(format!("shift={shift}")),
        MachineTime::Unbound { shift } => Some(format!("shift={shift},sleep=off")),
    };
    if let Some(icount) = icount {
        command.args(["-icount", &icount]);
    }
    command
}

/// A comma ends a value of QEMU's unless it is doubled.
fn escaped(path: &Path) -> String {
    path.to_string_lossy().replace(',', ",,")
}

/// Waits for the control socket.
fn control(child: &mut Child, path: &Path, stderr: &Collected) -> Result<Qmp, Error> {
    let start = Instant::now();
    loop {
        match Qmp::connect(path) {
            Ok(greeted) => return greeted,
            Err(cause) if start.elapsed() > START_LIMIT => return Err(Error::file(path)(cause)),
            Err(_) => {}
        }
        if let Some(status) = child.try_wait().map_err(Error::file(path))? {
            return Err(Error::Emulator {
                status,
                stderr: String::from_utf8_lossy(&stderr.whole()).into_owned(),
            });
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// What came out of a pipe so far; it is always read on, so that the child never waits for room.
struct Collected {
    bytes: Arc<Mutex<Vec<u8>>>,
    reader: thread::JoinHandle<()>,
}

impl Collected {
    fn of(pipe: Option<impl Read + Send + 'static>) -> Self {
        let bytes = Arc::new(Mutex::new(Vec::new()));
        let sink = bytes.clone();
        let reader = thread::spawn(move || {
            let mut block = [0; 4096];
            let Some(mut pipe) = pipe else { return };
            while let Ok(count @ 1..) = pipe.read(&mut block) {
                locked(&sink).extend_from_slice(&block[..count]);
            }
        });
        Self { bytes, reader }
    }

    fn so_far(&self) -> Vec<u8> {
        locked(&self.bytes).clone()
    }

    /// All, of a child that has ended.
    fn whole(&self) -> Vec<u8> {
        while !self.reader.is_finished() {
            thread::sleep(Duration::from_millis(1));
        }
        self.so_far()
    }
}
