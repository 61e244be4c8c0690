// node's tests, each with a limit: what waits for something that never comes fails and says so.
import * as node from 'node:test';

// The longest takes some seconds; on a machine that does other things as well, many times as long.
const kLimitMs = 150_000;

export const test = (name, body) => node.test(name, { timeout: kLimitMs }, body);
export const before = (body) => node.before(body, { timeout: kLimitMs });
export const after = (body) => node.after(body, { timeout: kLimitMs });
