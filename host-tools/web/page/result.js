// What is shown of a set, and handed out.

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

// Files of a set by their paths.
const ownFiles = (set, files) => [...files].filter(([path]) => path.startsWith(`${set.folder}/`));

// The same with their names alone, in order.
function filesIn(set, files) {
  const named = ownFiles(set, files).map(([path, bytes]) => [path.slice(set.folder.length + 1), bytes]);
  return named.sort(([a], [b]) => (a < b ? -1 : 1));
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
