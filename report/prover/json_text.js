// JSON with numbers as they are written, and keys that must not repeat.

// A number's text.
export class Numeral {
  constructor(text) {
    this.text = text;
  }
}

const blanks = /[ \t\n\r]*/y;
const numeral = /-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?/y;
const string = /"(?:[^"\\\u0000-\u001f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"/y;
const word = /true|false|null/y;

class Reader {
  constructor(text) {
    this.text = text;
    this.place = 0;
  }

  match(pattern) {
    pattern.lastIndex = this.place;
    const found = pattern.exec(this.text);
    if (found) this.place = pattern.lastIndex;
    return found?.[0];
  }
  next() {
    this.match(blanks);
    return this.text[this.place];
  }
  takes(character) {
    if (this.next() !== character) return false;
    ++this.place;
    return true;
  }
  expect(character) {
    if (!this.takes(character)) this.fail();
  }
  fail() {
    throw new Error(`the model's text is no JSON at character ${this.place}`);
  }

  value() {
    if (this.takes("{")) return this.object();
    if (this.takes("[")) return this.list("]", () => this.value());
    this.next();
    const quoted = this.match(string);
    if (quoted !== undefined) return JSON.parse(quoted);
    const digits = this.match(numeral);
    if (digits !== undefined) return new Numeral(digits);
    return JSON.parse(this.match(word) ?? this.fail());
  }
  list(end, item) {
    const items = [];
    if (this.takes(end)) return items;
    do items.push(item());
    while (this.takes(","));
    this.expect(end);
    return items;
  }
  object() {
    const entries = this.list("}", () => {
      this.next();
      const key = JSON.parse(this.match(string) ?? this.fail());
      this.expect(":");
      return [key, this.value()];
    });
    const result = new Map(entries);
    if (result.size !== entries.length) throw new Error("a key of the model's text repeats");
    return result;
  }
}

// Objects become Maps, numbers Numerals.
export function parseJson(text) {
  const reader = new Reader(text);
  const value = reader.value();
  if (reader.next() !== undefined) reader.fail();
  return value;
}
