// Coupled pendulums, stepped by symplectic Euler: what `springstab probe` asks a program for, in JavaScript.
import { createInterface } from "node:readline";

const acceleration = (x) => x.map((a, i) => 400 * ((x[i - 1] ?? 0) - 2 * a + (x[i + 1] ?? 0)) - 10 * a);

for await (const line of createInterface({ input: process.stdin })) {
  const { h, x, v } = JSON.parse(line);
  const kicked = acceleration(x).map((a, i) => v[i] + h * a);
  console.log(JSON.stringify({ x: x.map((a, i) => a + h * kicked[i]), v: kicked }));
}
