// Files in memory, and files that the user chose: these stay on the disk and are read in slices.

// Bytes of a chosen file that are read at a time.
const SLICE_BYTES = 4 << 20;

class MemoryFile {
  constructor(bytes = new Uint8Array(0)) {
    this.bytes = bytes;
    this.size = bytes.length;
  }

  read(offset, into) {
    const part = this.bytes.subarray(offset, Math.min(offset + into.length, this.size));
    into.set(part);
    return part.length;
  }

  write(offset, from) {
    const end = offset + from.length;
    if (end > this.bytes.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.bytes.length));
      larger.set(this.bytes.subarray(0, this.size));
      this.bytes = larger;
    }
    this.bytes.set(from, offset);
    this.size = Math.max(this.size, end);
  }

  truncate() {
    this.size = 0;
  }

  contents() {
    return this.bytes.slice(0, this.size);
  }
}

class ChosenFile {
  constructor(blob, onRead) {
    this.blob = blob;
    this.size = blob.size;
    this.onRead = onRead;
    this.start = 0;
    this.slice = new Uint8Array(0);
  }

  read(offset, into) {
    if (offset >= this.size) {
      return 0;
    }
    if (offset < this.start || offset >= this.start + this.slice.length) {
      const part = this.blob.slice(offset, offset + SLICE_BYTES);
      // Only a worker has it. It fails if the file was changed or taken away.
      this.slice = new Uint8Array(new FileReaderSync().readAsArrayBuffer(part));
      this.start = offset;
    }
    const from = offset - this.start;
    const part = this.slice.subarray(from, from + into.length);
    into.set(part);
    this.onRead(part.length);
    return part.length;
  }
}

// Folders and files by their paths, which have no slash in front: "logs/a.csv".
class FileTree {
  constructor() {
    this.files = new Map();
    this.folders = new Set([""]);
  }

  add(path, file) {
    const parts = path.split("/");
    for (let depth = 1; depth < parts.length; depth += 1) {
      this.folders.add(parts.slice(0, depth).join("/"));
    }
    this.files.set(path, file);
  }

  // Names in a folder, with whether each is a folder.
  list(folder) {
    const prefix = folder === "" ? "" : `${folder}/`;
    const names = new Map();
    for (const [paths, isFolder] of [[this.folders, true], [this.files.keys(), false]]) {
      for (const path of paths) {
        const name = path.slice(prefix.length);
        if (path !== folder && path.startsWith(prefix) && !name.includes("/")) {
          names.set(name, isFolder);
        }
      }
    }
    return [...names];
  }
}
