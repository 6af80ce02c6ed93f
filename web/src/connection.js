// The way to the process that runs: the Foxglove WebSocket protocol at the address of the page.

import FoxgloveClient from "@foxglove/ws-protocol/dist/esm/src/FoxgloveClient.js";

const kProtocols = [FoxgloveClient.SUPPORTED_SUBPROTOCOL, "foxglove.sdk.v1"];
const kAgain = 1000; // milliseconds until the next try
const kClientTopics = ["/push", "/pliant/stop", "/pliant/acknowledge"];

/// Calls `opened(session, first)` whenever a server is reached, with its session and whether it is the
/// first; `lost()` when it goes; `rows(data, first)` for each message of rows, with whether it is the
/// first since then; `state(about)`, `values([{name, value}])` of parameters, `status({level, message})`.
export class Connection {
  constructor(address, listener) {
    this.address = address;
    this.listener = listener;
    this.sessions = 0;
    this.wanted = true;
    this.#open();
  }

  get isOpen() {
    return Boolean(this.client);
  }

  /// A server that goes now is not looked for again.
  rest() {
    this.wanted = false;
    clearTimeout(this.timer);
  }

  #open() {
    const client = new FoxgloveClient({ ws: new WebSocket(this.address, kProtocols) });
    const topics = new Map(); // of subscriptions
    let fresh = true;
    client.on("serverInfo", ({ sessionId, capabilities }) => {
      this.client = client;
      const publishes = capabilities?.includes("clientPublish");
      this.channels = new Map(
        (publishes ? kClientTopics : []).map((topic) => [
          topic,
          client.advertise({ topic, encoding: "json", schemaName: "" }),
        ]),
      );
      this.listener.opened(sessionId, this.sessions++ === 0);
    });
    client.on("advertise", (channels) => {
      for (const { id, topic } of channels)
        if (topic === "/pliant/rows" || topic === "/pliant/run")
          topics.set(client.subscribe(id), topic);
    });
    client.on("message", ({ subscriptionId, data }) => {
      if (topics.get(subscriptionId) === "/pliant/run")
        this.listener.state(JSON.parse(new TextDecoder().decode(data)));
      else {
        this.listener.rows(data, fresh);
        fresh = false;
      }
    });
    client.on("parameterValues", ({ parameters }) => this.listener.values(parameters));
    client.on("status", (status) => this.listener.status(status));
    client.on("error", () => {}); // what ends a connection closes it too
    client.on("close", () => {
      const was = this.client === client;
      if (was) this.client = null;
      if (was) this.listener.lost();
      if (this.wanted) this.timer = setTimeout(() => this.#open(), kAgain);
    });
  }

  watchParameters(names) {
    this.client?.getParameters(names);
    this.client?.subscribeParameterUpdates(names);
  }

  setParameter(name, value) {
    const type =
      typeof value === "number" ? "float64" : Array.isArray(value) ? "float64_array" : undefined;
    this.client?.setParameters([{ name, value, type }]);
  }

  publish(topic, message) {
    const channel = this.channels?.get(topic);
    if (this.client && channel !== undefined)
      this.client.sendMessage(channel, new TextEncoder().encode(JSON.stringify(message)));
  }
}
