// .sweep files as ../../docs/format-sweep.md has them: enough to take the frames out.

/** The records of a .sweep file: { name, frame }. */
export function readSweepFile(bytes) {
  if (bytes.toString('latin1', 0, 8) !== 'SWEEPCST') throw new Error('not a .sweep file');
  const records = [];
  for (let at = 16; at + 9 <= bytes.length; ) {
    const size = bytes.readUInt32LE(at);
    if (size === 0xffffffff) break; // the index begins
    const nameSize = bytes.readUInt8(at + 4);
    const frameAt = at + 5 + nameSize + 4;
    records.push({
      name: bytes.toString('utf8', at + 5, at + 5 + nameSize),
      frame: bytes.subarray(frameAt, frameAt + size),
    });
    at = frameAt + size;
  }
  return records;
}
