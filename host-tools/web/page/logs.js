// The chosen logs, how they are to be read, and what their columns are taken for.

// Columns that are listed without being asked for.
const MOST_OPEN_COLUMNS = 8;

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

// The options of the command that say how to read a log.
function readingOptions() {
  const lines = (id) => $(id).value.split("\n").map((line) => line.trim()).filter((line) => line !== "");
  const option = (name, id) => lines(id).map((line) => `--${name}=${line}`);
  const join = logs.filter((log) => log.use === "join").map((log) => `--join=/${log.path}`);
  return [...option("time", "time"), ...option("temp", "temp"), ...option("axis", "axis"), ...option("where", "where"),
    ...option("instance", "instance"), ...option("scale-factor", "scale_factor"), ...join,
    ...($("skip").checked ? ["--skip-bad-rows"] : [])];
}

const logFiles = () => Object.fromEntries(logs.map((log) => [log.path, log.file]));

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
      const { result } = await job(logFiles(), ["columns", `/${log.path}`, "--json", ...options]);
      const answer = result.code === 0 ? JSON.parse(result.out) : null;
      [log.columns, log.note] = [answer?.columns ?? null, answer?.reading ?? null];
      log.error = answer ? null : complaint(result);
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
