// node replay.mjs MODULES TRACE CAPACITY...: hits of caches that others wrote, as JSON.
//
// TRACE: oracleGeneral layout (core/io/trace_file.h); items count as one each. MODULES: the folder
// in which npm has installed lru-cache and @neophi/sieve-cache.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const RECORD_BYTES = 24;
const [modules, trace, ...capacities] = process.argv.slice(2);
const load = createRequire(modules + "/");
const { LRUCache } = load("lru-cache");
const { SieveCache } = load("@neophi/sieve-cache");

const bytes = readFileSync(trace);
const requests = [];
for (let at = 0; at < bytes.length; at += RECORD_BYTES) requests.push(bytes.readBigUInt64LE(at + 4));

const makers = {
  lru: (capacity) => new LRUCache({ max: capacity }),
  sieve: (capacity) => new SieveCache(capacity),
};
const rows = [];
for (const capacity of capacities.map(Number)) {
  for (const [policy, make] of Object.entries(makers)) {
    const cache = make(capacity);
    let hits = 0;
    for (const id of requests) {
      if (cache.get(id) !== undefined) ++hits;
      else cache.set(id, true);
    }
    rows.push({ policy, capacity, hits });
  }
}
const versions = Object.fromEntries(
  ["lru-cache", "@neophi/sieve-cache"].map((name) => [
    name,
    JSON.parse(readFileSync(`${modules}/node_modules/${name}/package.json`)).version,
  ]),
);
console.log(JSON.stringify({ versions, rows }));
