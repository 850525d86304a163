// The page: logs are chosen, their columns shown, a set is fitted, judged, shown and handed out. All of it is
// done by the command, in a worker for each job.

// Longer logs are for the command, which uses all cores.
const MOST_BYTES = 1e9;

const $ = (id) => document.getElementById(id);

// Columns that are listed without being asked for.
const MOST_OPEN_COLUMNS = 8;

// An element with its properties and what it holds.
function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

// ---- jobs

async function unpacked() {
  const text = $("command").textContent.trim();
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

const command = unpacked();
const workerUrl = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));

// Runs commands, each with its arguments, on files by their paths. `signal` ends the job.
async function job(files, commands, onRead = () => {}, signal = new AbortController().signal) {
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
      worker.postMessage({ module, files, commands });
    });
  } finally {
    worker.terminate();
  }
}

// What a command said on standard error, without the word that it begins with.
const complaint = (result) => result.err.trim().replace(/^error: /, "").replaceAll("/logs/", "");

// ---- logs

// Each with file, path, use ("fit", "verify" or "join") and what was found in it.
let logs = [];

function add(files) {
  for (const file of files) {
    const number = logs.filter((log) => log.file.name === file.name).length;
    const path = number === 0 ? `logs/${file.name}` : `logs/${number + 1}/${file.name}`;
    const use = /verif/i.test(file.name) ? "verify" : "fit";
    logs.push({ file, path, use, columns: null, error: null, note: null });
  }
  showLogs();
  look();
}

function showLogs() {
  const uses = [["fit", "fit"], ["verify", "judge only (verification)"], ["join", "temperatures of the others"]];
  $("logs").replaceChildren(...logs.map((log) => {
    const options = uses.map(([value, text]) => element("option", { value, selected: log.use === value }, text));
    const use = element("select", { ariaLabel: `Use of ${log.file.name}` }, ...options);
    use.onchange = () => {
      log.use = use.value;
      look();
    };
    const remove = element("button", { type: "button", ariaLabel: `Remove ${log.file.name}` }, "Remove");
    remove.onclick = () => {
      logs = logs.filter((other) => other !== log);
      showLogs();
      look();
    };
    const size = `${(log.file.size / 1e6).toFixed(1)} MB`;
    const row = element("div", { className: "row" }, element("span", { className: "name" }, log.file.name), size, use,
      remove);
    return element("li", {}, row, found(log));
  }));
}

function found(log) {
  const box = element("div");
  if (log.error) {
    box.append(element("p", { className: "alert" }, log.error));
  }
  if (log.columns) {
    const rows = log.columns.map(({ name, role, unit, axes }) => {
      const names = axes.join(", ");
      const use = { axis: `axis ${names}`, temperature: `temperature of ${names}` }[role] ?? role ?? "not used";
      return [name, use, unit ?? ""];
    });
    const found = element("details", { open: rows.length <= MOST_OPEN_COLUMNS },
      element("summary", {}, `${rows.length} columns`), scrolled(table(["column", "taken for", "unit"], rows)));
    box.append(found);
  }
  if (log.note) {
    box.append(element("p", {}, `Read as: ${log.note}`));
  }
  return box;
}

function table(header, rows, className = "") {
  const line = (cells, kind) => element("tr", {}, ...cells.map((cell) => element(kind, {}, cell)));
  const head = element("thead", {}, line(header, "th"));
  return element("table", { className }, head, element("tbody", {}, ...rows.map((row) => line(row, "td"))));
}

// ---- options

// The options of the command that say how to read a log.
function readingOptions() {
  const lines = (id) => $(id).value.split("\n").map((line) => line.trim()).filter((line) => line !== "");
  const option = (name, id) => lines(id).map((line) => `--${name}=${line}`);
  const join = logs.filter((log) => log.use === "join").map((log) => `--join=/${log.path}`);
  return [...option("time", "time"), ...option("temp", "temp"), ...option("axis", "axis"), ...option("where", "where"),
    ...option("instance", "instance"), ...option("scale-factor", "scale_factor"), ...join,
    ...($("skip").checked ? ["--skip-bad-rows"] : [])];
}

const filesOf = (some) => Object.fromEntries(some.map((log) => [log.path, log.file]));

// Which look is the last: results of former ones are not shown.
let looks = 0;

// Shows what the columns of each log are taken for.
async function look() {
  looks += 1;
  const mine = looks;
  const options = readingOptions();
  for (const log of logs.filter((log) => log.use !== "join")) {
    const before = JSON.stringify([log.columns, log.error, log.note]);
    try {
      const { results } = await job(filesOf(logs), [["columns", `/${log.path}`, "--json", ...options]]);
      const answer = results[0].code === 0 ? JSON.parse(results[0].out) : null;
      [log.columns, log.note] = [answer?.columns ?? null, answer?.reading ?? null];
      log.error = answer ? null : complaint(results[0]);
    } catch (failure) {
      [log.columns, log.note, log.error] = [null, null, failure.message];
    }
    if (mine !== looks) {
      return;
    }
    if (before !== JSON.stringify([log.columns, log.error, log.note])) {
      showLogs();
    }
  }
  if (logs.some((log) => log.error)) {
    $("mapping").open = true;
  }
}

// ---- fit

// Ends what is under way.
let cancel = new AbortController();

function say(id, text) {
  $(id).textContent = text;
  $(id).hidden = text === "";
}

function busy(is) {
  $("fit").disabled = is;
  $("cancel").hidden = !is;
  $("progress").hidden = !is;
  $("progress").value = 0;
}

async function fit() {
  const [fitted, judged] = [logs.filter((log) => log.use === "fit"), logs.filter((log) => log.use === "verify")];
  say("error", "");
  say("refused", "");
  $("result").replaceChildren();
  if (fitted.length === 0) {
    say("refused", "No log to fit: choose one above.");
    return;
  }
  const bytes = logs.reduce((sum, log) => sum + log.file.size, 0);
  if (bytes > MOST_BYTES) {
    say("refused", `The logs have ${(bytes / 1e9).toFixed(1)} GB: expected at most 1 GB. For longer ones there is the `
      + "command, tempco fit.");
    return;
  }
  busy(true);
  const options = readingOptions();
  const names = fitted.map((log) => `/${log.path}`);
  const serial = $("serial").value.trim();
  const args = [`--serial=${serial}`, `--model=${$("model").value}`, ...options];
  // Each log is read twice: for the fit and for its report.
  let before = 0;
  const onRead = (of) => (read) => {
    $("progress").value = Math.min((before + read) / (2 * of), 1);
  };
  cancel = new AbortController();
  const { signal } = cancel;
  const task = (files, commands, of) => job(files, commands, onRead(of), signal);
  try {
    say("state", "Fitting");
    const made = await task(filesOf(logs), [["fit", ...names, ...args, "--out=/set", "--json"]], bytes);
    const [answer] = made.results;
    if (answer.code === 2) {
      throw new Error(complaint(answer));
    }
    const sets = answer.out.trim().split("\n").map((line) => JSON.parse(line));
    const files = new Map(made.files);
    for (const set of sets) {
      set.folder = set.files[0].replace(/^\//, "").replace(/\/[^/]*$/, "");
      set.checks = [];
      before = 0;
      for (const [number, log] of judged.entries()) {
        say("state", `Judging by ${log.file.name}`);
        set.checks.push(await verify(set, files, log, number, options, task));
      }
      set.parameters = await parameters(set, files, task);
    }
    show(sets, files, shownCommands(fitted, judged, args));
    say("state", "");
  } catch (failure) {
    say("state", "");
    say("error", failure.message);
  } finally {
    busy(false);
  }
}

// Judges a set by a log that it was not fitted to, and keeps the sign-off in it.
async function verify(set, files, log, number, options, task) {
  const report = `${set.folder}/verification-${number + 1}.html`;
  const own = [...files].filter(([path]) => path.startsWith(`${set.folder}/`));
  const args = ["evaluate", `/${set.folder}/coefficients.json`, `/${log.path}`, "--sign-off", `--report=/${report}`,
    "--json", ...options];
  const made = await task({ ...filesOf(logs), ...Object.fromEntries(own) }, [args], log.file.size);
  const [answer] = made.results;
  made.files.forEach(([path, bytes]) => files.set(path, bytes));
  return answer.code === 2
    ? { name: log.file.name, error: complaint(answer) }
    : { name: log.file.name, ...JSON.parse(answer.out.trim().split("\n").at(-1)) };
}

// Adds the parameters of autopilots to the files; returns what is to be said of each.
async function parameters(set, files, task) {
  const path = `${set.folder}/coefficients.json`;
  const deviceId = $("device_id").value.trim();
  const said = [];
  for (const [autopilot, file, options] of [["px4", "px4.params", deviceId && [`--device-id=${deviceId}`]],
    ["ardupilot", "ardupilot.param", []]]) {
    const out = `${set.folder}/${file}`;
    const args = ["export", `/${path}`, `--to=${autopilot}`, `--out=/${out}`, ...options];
    const made = await task({ [path]: files.get(path) }, [args], 0);
    const [{ code, err }] = made.results;
    if (code === 0) {
      files.set(out, new Map(made.files).get(out));
    }
    if (err !== "") {
      const what = code === 0 ? `Parameters for ${autopilot}` : `No parameters for ${autopilot}`;
      said.push(`${what}: ${complaint(made.results[0]).replace(`/${path}: `, "")}`);
    }
  }
  return said;
}

// The commands that do the same.
function shownCommands(fitted, judged, args) {
  const quoted = (text) => (/^[\w.,:=/+-]+$/.test(text) ? text : `"${text}"`);
  const line = (...words) => words.map((word) => quoted(word.replace(/^(--join=)?\/logs\//, "$1"))).join(" ");
  const reading = args.slice(2);
  const fit = line("tempco", "fit", ...fitted.map((log) => log.file.name), ...args, "--out=set");
  const evaluate = judged.map((log) => line("tempco", "evaluate", "set/coefficients.json", log.file.name, "--sign-off",
    ...reading));
  return [fit, ...evaluate].join("\n");
}

// ---- result

const figure = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "-");
const percent = (part) => (Number.isFinite(part) ? `${part > 0 ? "+" : ""}${(100 * part).toFixed(1)} %` : "-");
const words = (name) => name.replaceAll("_", " ");
const units = { pulses_per_s: "pulses/s", dph: "deg/h", dps: "deg/s", radps: "rad/s", mps2: "m/s²" };
const unitOf = (name) => units[name] ?? name;

function show(sets, files, commands) {
  const boxes = sets.map((set) => {
    const { serial } = set.set;
    return element("section", {}, element("h2", {}, `Unit ${serial}`), ...judgement(set), ...ofFit(set),
      ...set.checks.flatMap(ofCheck), ...downloads(set, files), ...reports(set, files));
  });
  const same = element("details", {}, element("summary", {}, "The same by the command line"), element("pre", {}, commands));
  $("result").replaceChildren(...boxes, same);
  $("result").querySelector("h2").scrollIntoView();
}

// The last word on a set: of its verification, if there was one.
function judgement(set) {
  const judged = [set, ...set.checks.filter((check) => !check.error)];
  const worst = judged.find((of) => of.verdict === "rejected") ?? judged.at(-1);
  const standing = worst.verified && worst.verdict !== "rejected" ? ", verified"
    : set.checks.length === 0 ? ", not yet verified" : "";
  const word = element("span", { className: worst.verdict }, words(worst.verdict));
  return [element("p", { className: "verdict" }, "Verdict: ", word, standing), ...reasons(worst)];
}

function reasons(judged) {
  const all = [["rejection", judged.rejections], ["warning", judged.warnings]];
  const items = all.flatMap(([kind, list]) => list.map(({ code, message }) =>
    element("li", {}, element("strong", {}, `${kind} `), element("code", {}, code), `: ${message}`)));
  return items.length > 0 ? [element("ul", {}, ...items)] : [];
}

function ofFit({ set }) {
  const ranges = set.channels.map(({ temperature, table: of }) => {
    const thermal = of.thermal;
    return [temperature, `${figure(of.t_min_c)} to ${figure(of.t_max_c)} °C`,
      `${figure(thermal.rate_min_c_per_min)} to ${figure(thermal.rate_max_c_per_min)} °C/min`];
  });
  const axes = set.channels.flatMap((channel) => channel.axes);
  const tau = axes.find((axis) => axis.statistics)?.statistics.tau_s;
  const rows = axes.map(({ name, unit, statistics, held_out: heldOut }) => {
    const { sigma_raw: before, sigma_compensated: after } = statistics ?? {};
    return [name, unitOf(unit), figure(before), figure(after), percent(1 - after / before),
      heldOut ? `${figure(heldOut.none)} → ${figure(heldOut.chosen)}` : "-"];
  });
  const header = ["axis", "unit", "before", "after", "improvement", "held out"];
  return [element("h3", {}, "Calibrated range"),
    scrolled(table(["temperature", "T", "rate of T"], ranges)),
    element("h3", {}, `Bias stability at ${tau} s on the fitted logs`),
    scrolled(table(header, rows, "figures")),
    element("p", {}, `Table CRC-32: ${set.table_crc32}`)];
}

function ofCheck(check) {
  if (check.error) {
    return [element("h3", {}, `Verification by ${check.name}`), element("p", { className: "alert" }, check.error)];
  }
  const rows = check.axes.map((of) => [of.axis, unitOf(of.unit), figure(of.sigma_raw), figure(of.sigma_compensated),
    percent(of.improvement)]);
  return [element("h3", {}, `Bias stability at ${check.tau_s} s on ${check.name}: `,
    element("span", { className: check.verdict }, words(check.verdict))),
  scrolled(table(["axis", "unit", "before", "after", "improvement"], rows, "figures"))];
}

const scrolled = (inner) => element("div", { className: "scroll" }, inner);

// Files of a set, with their names alone.
function filesIn(set, files) {
  const prefix = `${set.folder}/`;
  const own = [...files].filter(([path]) => path.startsWith(prefix));
  return own.map(([path, bytes]) => [path.slice(prefix.length), bytes]).sort(([a], [b]) => (a < b ? -1 : 1));
}

function downloads(set, files) {
  const own = filesIn(set, files);
  const { serial } = set.set;
  const link = (name, blob) => element("a", { href: URL.createObjectURL(blob), download: name }, name);
  const links = own.map(([name, bytes]) => element("li", {}, link(name, new Blob([bytes]))));
  const zip = element("li", {}, link(`${serial.replace(/[^\w.-]/g, "_")}.zip`, zipOf(own)));
  const said = set.parameters.map((text) => element("p", { className: "note" }, text));
  return [element("h3", {}, "Files"), element("ul", { className: "downloads" }, zip, ...links), ...said];
}

// The reports, one at a time, in a frame that may run nothing.
function reports(set, files) {
  const pages = filesIn(set, files).filter(([name]) => name.endsWith(".html"));
  const frame = element("iframe", { title: `Report on unit ${set.set.serial}` });
  frame.setAttribute("sandbox", "");
  const open = (number) => {
    frame.srcdoc = new TextDecoder().decode(pages[number][1]);
  };
  const options = pages.map(([name], value) => element("option", { value }, name));
  const choice = element("select", { ariaLabel: "Report to show" }, ...options);
  choice.onchange = () => open(Number(choice.value));
  open(0);
  return [element("h3", { className: "frame" }, "Report ", choice), frame];
}

// ---- what the user does

$("choose").onchange = () => {
  add($("choose").files);
  $("choose").value = "";
};
document.body.ondragover = (event) => {
  event.preventDefault();
  $("drop").classList.add("over");
};
document.body.ondragleave = () => $("drop").classList.remove("over");
document.body.ondrop = (event) => {
  event.preventDefault();
  $("drop").classList.remove("over");
  add(event.dataTransfer.files);
};
$("mapping").onchange = look;
$("form").onsubmit = (event) => {
  event.preventDefault();
  fit();
};
$("cancel").onclick = () => cancel.abort(new Error("cancelled"));
command.catch(() => say("error", "This browser cannot run the page: expected Chrome 103, Edge 103, Firefox 113, Safari 16.4 "
  + "or later."));
