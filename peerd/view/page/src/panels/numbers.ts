// Numbers as people read them, with units.
export function millisecondsText(value_ms: number | null | undefined): string {
  if (value_ms === null || value_ms === undefined) return '–';
  if (Math.abs(value_ms) >= 1000) return `${(value_ms / 1000).toFixed(1)} s`;
  return `${value_ms.toFixed(Math.abs(value_ms) < 10 ? 2 : Math.abs(value_ms) < 100 ? 1 : 0)} ms`;
}

export function shareText(value: number | null | undefined): string {
  return value === null || value === undefined ? '–' : `${(100 * value).toFixed(1)} %`;
}

export function bytesText(value: number | null | undefined): string {
  if (value === null || value === undefined) return '–';
  if (value < 1000) return `${Math.round(value)} B`;
  if (value < 1e6) return `${(value / 1000).toFixed(1)} kB`;
  return value < 1e9 ? `${(value / 1e6).toFixed(1)} MB` : `${(value / 1e9).toFixed(2)} GB`;
}

export function metresText(value_m: number | null | undefined): string {
  if (value_m === null || value_m === undefined || Number.isNaN(value_m)) return '–';
  if (value_m === 0) return '0 m';
  const size = Math.abs(value_m);
  if (size < 1e-3) return `${(value_m * 1e6).toFixed(0)} µm`;
  if (size < 0.1) return `${(value_m * 1000).toFixed(1)} mm`;
  return `${value_m.toFixed(size < 10 ? 3 : size < 1000 ? 2 : 0)} m`;
}

export function clockText(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || Number.isNaN(seconds)) return '–';
  const sign = seconds < 0 ? '−' : '';
  const whole = Math.abs(seconds);
  const minutes = Math.floor(whole / 60);
  return `${sign}${minutes}:${(whole - 60 * minutes).toFixed(1).padStart(4, '0')}`;
}
