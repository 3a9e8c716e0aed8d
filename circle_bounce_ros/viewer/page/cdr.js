// Serialized ROS messages (CDR, little-endian) read in place: what is not needed is not copied.

const HEADER = 4; // bytes before the message proper, which alignment does not count

class Reader {
  constructor(buffer, start) {
    this.view = new DataView(buffer);
    if (buffer.byteLength < start + HEADER) throw new Error('the message ends before its header does');
    if (this.view.getUint8(start + 1) !== 1) throw new Error('only little-endian CDR can be read');
    this.base = start + HEADER;
    this.position = 0;
  }

  next(size) {
    this.position += (size - (this.position % size)) % size;
    return this.take(size);
  }

  // Returns where so many bytes begin that the message must have.
  take(size) {
    const at = this.base + this.position;
    if (at + size > this.view.byteLength) throw new Error(`the message ends too early: ${size} bytes are missing at ${at}`);
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
    const bytes = new Uint8Array(this.view.buffer, this.take(length), Math.max(0, length - 1));
    return new TextDecoder().decode(bytes);
  }

  // A sequence of elements that are `size` bytes long, made of numbers of `unit` bytes.
  skip(size, unit) {
    const count = this.uint32();
    if (!count) return;
    this.position += (unit - (this.position % unit)) % unit;
    this.take(count * size);
  }

  header() {
    const seconds = this.int32();
    const nanoseconds = this.uint32();
    return { stamp: `${seconds}.${String(nanoseconds).padStart(9, '0')}`, frame: this.text() };
  }
}

// Bytes of each datatype of sensor_msgs/PointField.
const SIZES = { 1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 8: 8 };

// sensor_msgs/PointCloud2: where its points are, field by field. What contradicts itself is refused, so that nobody
// looks for points that are not there.
export function readCloud(buffer, start) {
  const reader = new Reader(buffer, start);
  const { stamp, frame } = reader.header();
  const height = reader.uint32();
  const width = reader.uint32();
  const fields = Object.create(null); // a name may be any, __proto__ too
  for (let left = reader.uint32(); left > 0; left -= 1) {
    const name = reader.text();
    must(name && !(name in fields), 'fields', 'have names that differ', `“${name}”`);
    fields[name] = { offset: reader.uint32(), type: reader.uint8() };
    const numbers = reader.uint32();
    must(numbers === 1, `fields.${name}`, 'have count 1', numbers);
  }
  must(!reader.uint8(), 'is_bigendian', 'be false', 'true');
  const step = reader.uint32();
  must(step > 0, 'point_step', 'be > 0', step);
  for (const [name, { offset, type }] of Object.entries(fields)) {
    must(type in SIZES, `fields.${name}`, 'have a datatype from 1 to 8', type);
    must(offset + SIZES[type] <= step, `fields.${name}`, `end within point_step = ${step} bytes`, offset + SIZES[type]);
  }
  const row = reader.uint32();
  must(row === width * step, 'row_step', `be width * point_step = ${width * step}`, row);
  const length = reader.uint32();
  must(length === height * row, 'data', `have height * row_step = ${height * row} bytes`, length);
  return { stamp, frame, count: height * width, fields, step, start: reader.take(length), length };
}

function must(isRight, place, rule, got) {
  if (!isRight) throw new Error(`${place}: must ${rule}, got ${got}`);
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
    must([...position, ...scale, ...points.flat()].every(Number.isFinite), `${ns} ${id}`, 'have finite numbers', 'others');
    return { ns, id, type, action, position, scale, colour, points };
  });
}
