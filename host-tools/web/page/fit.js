// From the logs to sets: fitted, judged, and with parameters for autopilots. All of it is done by the command.

// Longer logs are for the command outside of a browser, which uses all cores.
const MOST_BYTES = 1e9;

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
  const onRead = (of) => (read) => {
    $("progress").value = Math.min(read / (2 * of), 1);
  };
  cancel = new AbortController();
  const { signal } = cancel;
  const task = (files, args, of) => job(files, args, onRead(of), signal);
  try {
    say("state", "Fitting");
    const made = await task(logFiles(), ["fit", ...names, ...args, "--out=/set", "--json"], bytes);
    const answer = made.result;
    if (answer.code === 2) {
      throw new Error(complaint(answer));
    }
    const sets = answer.out.trim().split("\n").map((line) => JSON.parse(line));
    const files = new Map(made.files);
    for (const set of sets) {
      set.folder = set.files[0].replace(/^\//, "").replace(/\/[^/]*$/, "");
      set.checks = [];
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
  const args = ["evaluate", `/${set.folder}/coefficients.json`, `/${log.path}`, "--sign-off", `--report=/${report}`,
    "--json", ...options];
  const made = await task({ ...logFiles(), ...Object.fromEntries(ownFiles(set, files)) }, args, log.file.size);
  const answer = made.result;
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
    const made = await task({ [path]: files.get(path) }, args, 0);
    const { code, err } = made.result;
    if (code === 0) {
      files.set(out, new Map(made.files).get(out));
    }
    if (err !== "") {
      const what = code === 0 ? `Parameters for ${autopilot}` : `No parameters for ${autopilot}`;
      said.push(`${what}: ${complaint(made.result).replace(`/${path}: `, "")}`);
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
