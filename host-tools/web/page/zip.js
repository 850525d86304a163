// A zip of files as they are, without packing (APPNOTE.TXT of PKWARE, sections 4.3.7, 4.3.12, 4.3.16).

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) {
      crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
  }
  return (crc ^ 0xffffffff) >>> 0;
}

// Fields of two or four bytes, the lowest byte first.
function fields(...values) {
  const bytes = [];
  for (const [value, width] of values) {
    for (let byte = 0; byte < width; byte += 1) {
      bytes.push(Math.floor(value / 2 ** (8 * byte)) & 0xff);
    }
  }
  return new Uint8Array(bytes);
}

// `files` are pairs of name and bytes.
function zipOf(files) {
  const [parts, directory] = [[], []];
  let [offset, directoryBytes] = [0, 0];
  // 1980-01-01, and names in UTF-8.
  const common = (name, bytes) => [[0x0800, 2], [0, 2], [0, 2], [0x21, 2], [crc32(bytes), 4], [bytes.length, 4],
    [bytes.length, 4], [name.length, 2], [0, 2]];
  for (const [text, bytes] of files) {
    const name = new TextEncoder().encode(text);
    const local = fields([0x04034b50, 4], [20, 2], ...common(name, bytes));
    const entry = fields([0x02014b50, 4], [20, 2], [20, 2], ...common(name, bytes), [0, 2], [0, 2], [0, 2], [0, 4],
      [offset, 4]);
    parts.push(local, name, bytes);
    directory.push(entry, name);
    offset += local.length + name.length + bytes.length;
    directoryBytes += entry.length + name.length;
  }
  const end = fields([0x06054b50, 4], [0, 2], [0, 2], [files.length, 2], [files.length, 2], [directoryBytes, 4],
    [offset, 4], [0, 2]);
  return new Blob([...parts, ...directory, end], { type: "application/zip" });
}
