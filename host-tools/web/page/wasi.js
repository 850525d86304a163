// What a program for WASI asks of its system (preview 1), as far as the command does: arguments, time,
// chance, and files. Numbers are those of the standard.

const SUCCESS = 0;
const BAD_DESCRIPTOR = 8;
const EXISTS = 20;
const INVALID = 28;
const FAILED_TO_READ = 29;
const IS_FOLDER = 31;
const NO_ENTRY = 44;
const NOT_EMPTY = 55;
const NOT_PERMITTED = 63;

const TYPE_UNKNOWN = 0;
const TYPE_FOLDER = 3;
const TYPE_FILE = 4;

// The root of the files: the only folder that is open at the start.
const ROOT = 3;

class Exit extends Error {
  constructor(code) {
    super(`exit ${code}`);
    this.code = code;
  }
}

// Runs a program once, with its arguments, on a tree of files; returns its exit code and what it
// printed. A trap of the program is thrown.
async function run(module, args, tree) {
  const encoder = new TextEncoder();
  const decoder = new TextDecoder();
  const printed = { 1: new MemoryFile(), 2: new MemoryFile() };
  // The open files: file, or folder, and the place in it.
  const open = new Map([[ROOT, { folder: "" }]]);
  let nextDescriptor = ROOT + 1;
  let memory;

  const view = () => new DataView(memory.buffer);
  const bytes = (pointer, length) => new Uint8Array(memory.buffer, pointer, length);
  const setU32 = (pointer, value) => view().setUint32(pointer, value, true);
  const setU64 = (pointer, value) => view().setBigUint64(pointer, BigInt(value), true);

  const pathOf = (descriptor, pointer, length) => {
    const base = open.get(descriptor)?.folder ?? "";
    const parts = base.split("/").concat(decoder.decode(bytes(pointer, length)).split("/"));
    return parts.filter((part) => part !== "" && part !== ".").join("/");
  };
  // Each of the buffers that a call has, until one is not filled.
  const each = (list, count, take) => {
    let total = 0;
    for (let number = 0; number < count; number += 1) {
      const place = list + 8 * number;
      const buffer = bytes(view().getUint32(place, true), view().getUint32(place + 4, true));
      const done = take(buffer);
      total += done;
      if (done < buffer.length) {
        break;
      }
    }
    return total;
  };
  const texts = (list, pointers, place) => {
    for (const text of list) {
      setU32(pointers, place);
      const encoded = encoder.encode(`${text}\0`);
      bytes(place, encoded.length).set(encoded);
      pointers += 4;
      place += encoded.length;
    }
    return SUCCESS;
  };
  const sizes = (list, count, length) => {
    setU32(count, list.length);
    setU32(length, list.reduce((sum, text) => sum + encoder.encode(text).length + 1, 0));
    return SUCCESS;
  };
  const describe = (out, type, size) => {
    bytes(out, 64).fill(0);
    bytes(out + 16, 1)[0] = type;
    setU64(out + 24, 1);
    setU64(out + 32, size);
    return SUCCESS;
  };
  const describePath = (path, out) => {
    if (tree.folders.has(path)) {
      return describe(out, TYPE_FOLDER, 0);
    }
    const file = tree.files.get(path);
    return file ? describe(out, TYPE_FILE, file.size) : NO_ENTRY;
  };

  const system = {
    args_sizes_get: (count, length) => sizes(args, count, length),
    args_get: (pointers, place) => texts(args, pointers, place),
    environ_sizes_get: (count, length) => sizes([], count, length),
    environ_get: () => SUCCESS,
    clock_time_get: (clock, _precision, out) => {
      const ms = clock === 0 ? Date.now() : performance.now();
      setU64(out, Math.round(ms * 1e6));
      return SUCCESS;
    },
    random_get: (pointer, length) => {
      for (let from = 0; from < length; from += 65536) {
        crypto.getRandomValues(bytes(pointer + from, Math.min(65536, length - from)));
      }
      return SUCCESS;
    },
    sched_yield: () => SUCCESS,
    proc_exit: (code) => {
      throw new Exit(code);
    },

    fd_prestat_get: (descriptor, out) => {
      if (descriptor !== ROOT) {
        return BAD_DESCRIPTOR;
      }
      setU32(out, 0);
      setU32(out + 4, 1);
      return SUCCESS;
    },
    fd_prestat_dir_name: (_descriptor, pointer) => {
      bytes(pointer, 1).set(encoder.encode("/"));
      return SUCCESS;
    },
    fd_fdstat_get: (descriptor, out) => {
      const entry = open.get(descriptor);
      if (!entry && !printed[descriptor] && descriptor !== 0) {
        return BAD_DESCRIPTOR;
      }
      bytes(out, 24).fill(0);
      // No terminal stands behind what is printed.
      bytes(out, 1)[0] = entry ? (entry.file ? TYPE_FILE : TYPE_FOLDER) : TYPE_UNKNOWN;
      setU64(out + 8, 0xffffffffn);
      setU64(out + 16, 0xffffffffn);
      return SUCCESS;
    },
    fd_filestat_get: (descriptor, out) => {
      const entry = open.get(descriptor);
      if (!entry) {
        return printed[descriptor] ? describe(out, TYPE_UNKNOWN, 0) : BAD_DESCRIPTOR;
      }
      return entry.file ? describe(out, TYPE_FILE, entry.file.size) : describe(out, TYPE_FOLDER, 0);
    },
    fd_read: (descriptor, list, count, out) => {
      const entry = open.get(descriptor);
      if (!entry?.file) {
        return BAD_DESCRIPTOR;
      }
      try {
        const read = each(list, count, (buffer) => {
          const done = entry.file.read(entry.place, buffer);
          entry.place += done;
          return done;
        });
        setU32(out, read);
        return SUCCESS;
      } catch {
        return FAILED_TO_READ;
      }
    },
    fd_write: (descriptor, list, count, out) => {
      const entry = printed[descriptor]
        ? { file: printed[descriptor], place: printed[descriptor].size }
        : open.get(descriptor);
      if (!entry?.file) {
        return BAD_DESCRIPTOR;
      }
      if (!entry.file.write) {
        return NOT_PERMITTED;
      }
      const written = each(list, count, (buffer) => {
        entry.file.write(entry.place, buffer);
        entry.place += buffer.length;
        return buffer.length;
      });
      setU32(out, written);
      return SUCCESS;
    },
    fd_seek: (descriptor, offset, whence, out) => {
      const entry = open.get(descriptor);
      if (!entry?.file) {
        return BAD_DESCRIPTOR;
      }
      const place = Number(offset) + [0, entry.place, entry.file.size][whence];
      if (place < 0) {
        return INVALID;
      }
      entry.place = place;
      setU64(out, place);
      return SUCCESS;
    },
    fd_sync: () => SUCCESS,
    fd_close: (descriptor) => (open.delete(descriptor) ? SUCCESS : BAD_DESCRIPTOR),
    fd_readdir: (descriptor, pointer, length, cookie, out) => {
      const entry = open.get(descriptor);
      if (entry?.folder === undefined) {
        return BAD_DESCRIPTOR;
      }
      let used = 0;
      const names = tree.list(entry.folder);
      for (let number = Number(cookie); number < names.length && used < length; number += 1) {
        const [name, isFolder] = names[number];
        const encoded = encoder.encode(name);
        const record = new Uint8Array(24 + encoded.length);
        const fields = new DataView(record.buffer);
        fields.setBigUint64(0, BigInt(number + 1), true);
        fields.setUint32(16, encoded.length, true);
        record[20] = isFolder ? TYPE_FOLDER : TYPE_FILE;
        record.set(encoded, 24);
        // A record that does not fit ends the buffer; the caller asks again from its number on.
        const part = record.subarray(0, length - used);
        bytes(pointer + used, part.length).set(part);
        used += part.length;
      }
      setU32(out, used);
      return SUCCESS;
    },

    path_open: (base, _follow, pointer, length, how, _rights, _inherited, _flags, out) => {
      const path = pathOf(base, pointer, length);
      const [create, folder, exclusive, truncate] = [1, 2, 4, 8].map((bit) => (how & bit) !== 0);
      let entry;
      if (tree.folders.has(path)) {
        entry = { folder: path };
      } else {
        let file = tree.files.get(path);
        if (folder || (!file && !create)) {
          return NO_ENTRY;
        }
        if (file && exclusive) {
          return EXISTS;
        }
        if (file && truncate && !file.truncate) {
          return NOT_PERMITTED;
        }
        if (!file) {
          file = new MemoryFile();
          tree.add(path, file);
        } else if (truncate) {
          file.truncate();
        }
        entry = { file, place: 0 };
      }
      open.set(nextDescriptor, entry);
      setU32(out, nextDescriptor);
      nextDescriptor += 1;
      return SUCCESS;
    },
    path_filestat_get: (base, _follow, pointer, length, out) =>
      describePath(pathOf(base, pointer, length), out),
    path_create_directory: (base, pointer, length) => {
      const path = pathOf(base, pointer, length);
      if (tree.folders.has(path) || tree.files.has(path)) {
        return EXISTS;
      }
      tree.folders.add(path);
      return SUCCESS;
    },
    path_remove_directory: (base, pointer, length) => {
      const path = pathOf(base, pointer, length);
      if (!tree.folders.has(path)) {
        return NO_ENTRY;
      }
      if (tree.list(path).length > 0) {
        return NOT_EMPTY;
      }
      tree.folders.delete(path);
      return SUCCESS;
    },
    path_unlink_file: (base, pointer, length) => {
      const path = pathOf(base, pointer, length);
      return tree.files.delete(path) ? SUCCESS : tree.folders.has(path) ? IS_FOLDER : NO_ENTRY;
    },
    path_link: (base, _follow, pointer, length, toBase, toPointer, toLength) => {
      const file = tree.files.get(pathOf(base, pointer, length));
      const to = pathOf(toBase, toPointer, toLength);
      if (!file || tree.files.has(to) || tree.folders.has(to)) {
        return file ? EXISTS : NO_ENTRY;
      }
      tree.add(to, file);
      return SUCCESS;
    },
    path_rename: (base, pointer, length, toBase, toPointer, toLength) => {
      const from = pathOf(base, pointer, length);
      const file = tree.files.get(from);
      if (!file) {
        return tree.folders.has(from) ? INVALID : NO_ENTRY;
      }
      tree.files.delete(from);
      tree.add(pathOf(toBase, toPointer, toLength), file);
      return SUCCESS;
    },
    path_readlink: () => INVALID,
  };

  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: system });
  memory = instance.exports.memory;
  let code = 0;
  try {
    instance.exports._start();
  } catch (stopped) {
    if (!(stopped instanceof Exit)) {
      const said = decoder.decode(printed[2].contents());
      throw new Error([stopped.message, said].filter((text) => text !== "").join(": "));
    }
    code = stopped.code;
  }
  return {
    code,
    out: decoder.decode(printed[1].contents()),
    err: decoder.decode(printed[2].contents()),
  };
}
