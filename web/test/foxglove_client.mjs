// The official client of the Foxglove WebSocket protocol, with promises of what it hears.

import { createRequire } from "node:module";
import { WebSocket } from "ws";

const { FoxgloveClient } = createRequire(import.meta.url)("@foxglove/ws-protocol");

export async function connect(address) {
  const socket = new WebSocket(address.replace(/^http/, "ws"), [
    FoxgloveClient.SUPPORTED_SUBPROTOCOL,
  ]);
  const client = new FoxgloveClient({ ws: socket });
  const channels = new Map(); // by topic
  client.on("advertise", (more) => more.forEach((channel) => channels.set(channel.topic, channel)));

  /// The first event of a kind that passes.
  const heard = (kind, passes = () => true) =>
    new Promise((done, fails) => {
      const listen = (event) => {
        if (!passes(event)) return;
        client.off(kind, listen);
        done(event);
      };
      client.on(kind, listen);
      client.on("close", () => fails(new Error(`the connection closed before a ${kind}`)));
    });

  const info = await heard("serverInfo");
  return {
    client,
    info,
    heard,
    async channel(topic) {
      while (!channels.has(topic)) await heard("advertise");
      return channels.get(topic);
    },
    topics: () => [...channels.keys()],
    /// The values that parameters have, by name; of all, without names.
    async parameters(...names) {
      const id = String(Math.random());
      const answer = heard("parameterValues", (event) => event.id === id);
      client.getParameters(names, id);
      return new Map((await answer).parameters.map(({ name, value }) => [name, value]));
    },
    close: () => client.close(),
  };
}
