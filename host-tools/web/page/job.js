// Runs the command in a worker of its own, made for each job.

async function unpacked() {
  const text = $("command").textContent.trim();
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

const command = unpacked();
const workerUrl = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));

// Runs the command with arguments on files by their paths: its result, and the files that it wrote. `signal`
// ends the job.
async function job(files, args, onRead = () => {}, signal = new AbortController().signal) {
  const module = await command;
  signal.throwIfAborted();
  const worker = new Worker(workerUrl);
  try {
    return await new Promise((resolve, reject) => {
      signal.onabort = () => reject(signal.reason);
      worker.onmessage = ({ data }) => {
        if (data.read !== undefined) {
          onRead(data.read);
        } else if (data.failure !== undefined) {
          reject(new Error(`a fault of tempco, please report it: ${data.failure}`));
        } else {
          resolve(data);
        }
      };
      worker.onerror = (event) => reject(new Error(`the worker ended: ${event.message}`));
      worker.postMessage({ module, files, args });
    });
  } finally {
    worker.terminate();
  }
}

// What a command said on standard error, without the word that it begins with.
const complaint = (result) => result.err.trim().replace(/^error: /, "").replaceAll("/logs/", "");
