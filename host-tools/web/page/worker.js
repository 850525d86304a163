// Runs the command once on some files, and says how far it is. A page makes a worker for each job; it
// is ended after the job, or before, to cancel it.

// Bytes between two messages of progress.
const PROGRESS_BYTES = 1 << 20;

// The job: the compiled command, files by their paths (chosen files, or bytes), the arguments.
self.onmessage = async ({ data: { module, files, args } }) => {
  try {
    let [read, said] = [0, 0];
    const onRead = (more) => {
      read += more;
      if (read - said >= PROGRESS_BYTES) {
        said = read;
        self.postMessage({ read });
      }
    };
    const tree = new FileTree();
    for (const [path, content] of Object.entries(files)) {
      const isChosen = content instanceof Blob;
      tree.add(path, isChosen ? new ChosenFile(content, onRead) : new MemoryFile(content));
    }
    const result = await run(module, ["tempco", ...args], tree);
    const made = [...tree.files].filter(([, file]) => file instanceof MemoryFile);
    self.postMessage({ result, files: made.map(([path, file]) => [path, file.contents()]) });
  } catch (failure) {
    self.postMessage({ failure: String(failure.message ?? failure) });
  }
};
