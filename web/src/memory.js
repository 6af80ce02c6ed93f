// What the reader has chosen, kept while the tab is open.

const kKey = "pliant";

export class Memory {
  constructor() {
    this.all = {};
    try {
      this.all = JSON.parse(sessionStorage.getItem(kKey)) ?? {};
    } catch {
      // Nothing is kept where a browser keeps nothing.
    }
  }

  get(name) {
    return this.all[name];
  }

  set(name, value) {
    this.all[name] = value;
    try {
      sessionStorage.setItem(kKey, JSON.stringify(this.all));
    } catch {
      // As above.
    }
  }
}
