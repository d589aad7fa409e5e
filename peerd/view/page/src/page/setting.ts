// A value that several parts of the page show or change.
export class Setting<Value> {
  private readonly listeners: ((value: Value) => void)[] = [];

  constructor(private current: Value) {}

  get value(): Value {
    return this.current;
  }
  set value(value: Value) {
    if (Object.is(value, this.current)) return;
    this.current = value;
    for (const listener of this.listeners) listener(value);
  }

  // Calls the listener with the value as it is now, and with each one that follows.
  follow(listener: (value: Value) => void): void {
    this.listeners.push(listener);
    listener(this.current);
  }
}
