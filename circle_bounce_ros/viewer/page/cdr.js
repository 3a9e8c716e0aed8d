// Serialized ROS messages (CDR, little-endian) read in place: what is not needed is not copied.

const HEADER = 4; // bytes before the message proper, which alignment does not count

class Reader {
  constructor(buffer, start) {
    this.view = new DataView(buffer);
    if (this.view.getUint8(start + 1) !== 1) throw new Error('only little-endian CDR can be read');
    this.base = start + HEADER;
    this.position = 0;
  }

  next(size) {
    this.position += (size - (this.position % size)) % size;
    const at = this.base + this.position;
    this.position += size;
    return at;
  }

  uint8() { return this.view.getUint8(this.next(1)); }
  int32() { return this.view.getInt32(this.next(4), true); }
  uint32() { return this.view.getUint32(this.next(4), true); }
  float32() { return this.view.getFloat32(this.next(4), true); }
  float64() { return this.view.getFloat64(this.next(8), true); }
  several(count, read) { return Array.from({ length: count }, () => this[read]()); }

  text() {
    const length = this.uint32();
    const bytes = new Uint8Array(this.view.buffer, this.base + this.position, Math.max(0, length - 1));
    this.position += length;
    return new TextDecoder().decode(bytes);
  }

  // A sequence of elements that are `size` bytes long, made of numbers of `unit` bytes.
  skip(size, unit) {
    const count = this.uint32();
    if (!count) return;
    this.position += (unit - (this.position % unit)) % unit;
    this.position += count * size;
  }

  header() {
    const seconds = this.int32();
    const nanoseconds = this.uint32();
    return { stamp: `${seconds}.${String(nanoseconds).padStart(9, '0')}`, frame: this.text() };
  }
}

// sensor_msgs/PointCloud2: where its points are, field by field.
export function readCloud(buffer, start) {
  const reader = new Reader(buffer, start);
  const { stamp, frame } = reader.header();
  const height = reader.uint32();
  const width = reader.uint32();
  const fields = {};
  for (let left = reader.uint32(); left > 0; left -= 1) {
    const name = reader.text();
    fields[name] = { offset: reader.uint32(), type: reader.uint8() };
    reader.uint32();
  }
  reader.uint8();
  const step = reader.uint32();
  reader.uint32();
  const length = reader.uint32();
  return { stamp, frame, count: height * width, fields, step, start: reader.base + reader.position, length };
}

// sensor_msgs/TimeReference: the scene time of a stamp, seconds.
export function readTime(buffer, start) {
  const reader = new Reader(buffer, start);
  const { stamp } = reader.header();
  const seconds = reader.int32() + reader.uint32() * 1e-9;
  return { stamp, seconds, scene: reader.text() };
}

// visualization_msgs/MarkerArray.
export function readMarkers(buffer, start) {
  const reader = new Reader(buffer, start);
  return Array.from({ length: reader.uint32() }, () => {
    reader.header();
    const ns = reader.text();
    const [id, type, action] = reader.several(3, 'int32');
    const position = reader.several(3, 'float64');
    reader.several(4, 'float64');
    const scale = reader.several(3, 'float64');
    const colour = reader.several(4, 'float32');
    reader.several(2, 'int32');
    reader.uint8();
    const points = Array.from({ length: reader.uint32() }, () => reader.several(3, 'float64'));
    reader.skip(16, 4); // colors
    reader.text(); // texture_resource
    reader.header(); // texture
    reader.text();
    reader.skip(1, 1);
    reader.skip(8, 4); // uv_coordinates
    reader.text(); // text
    reader.text(); // mesh_resource
    reader.text(); // mesh_file
    reader.skip(1, 1);
    reader.uint8();
    return { ns, id, type, action, position, scale, colour, points };
  });
}
