// A run that is shown: `pliant run FILE --view` at a port that is free.

import { spawn } from "node:child_process";

/// Once it listens: its address, the promise of its exit code, and `kill(signal)`.
export function show(pliant, file, ...more) {
  const child = spawn(pliant, ["run", file, "--view", "--port", "0", ...more], {
    stdio: ["ignore", "inherit", "pipe"],
  });
  const ended = new Promise((done) => child.on("exit", (code, signal) => done(code ?? signal)));
  process.on("exit", () => child.kill("SIGKILL"));
  let said = "";
  return new Promise((listens, fails) => {
    child.stderr.on("data", (text) => {
      said += text;
      const address = said.match(/(http:\/\/\S+) shows the run/)?.[1];
      if (address) listens({ address, ended, kill: (signal) => child.kill(signal) });
    });
    ended.then((code) => fails(new Error(`pliant ended with ${code}: ${said}`)));
  });
}
