// A chain of masses between two walls in MuJoCo (its WebAssembly build: npm install mujoco-js), for `springstab
// probe`: a real engine's integrator. Started from the folder where the package is installed:
//     springstab probe --size 9 --claims symplectic-euler -- node mujoco_chain.mjs CHAIN.json Euler none
// The last words are MuJoCo's integrator (Euler, RK4, implicit, implicitfast) and which dampers there are (none,
// spring, joint, both). CHAIN.json: {"mass": [n], "stiffness": [n + 1], "damping": [n + 1], "joint_damping": [n]}.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createInterface } from "node:readline";

const [file, integrator, dampers] = process.argv.slice(2);
const chain = JSON.parse(readFileSync(file, "utf8"));
const n = chain.mass.length;
const spring = dampers === "spring" || dampers === "both", joint = dampers === "joint" || dampers === "both";

const bodies = chain.mass.map((mass, i) => `
  <body><joint name="j${i}" type="slide" axis="1 0 0" damping="${joint ? chain.joint_damping[i] : 0}"/>
  <inertial pos="0 0 0" mass="${mass}" diaginertia="1 1 1"/></body>`);
const tendons = chain.stiffness.map((stiffness, i) => `
  <fixed stiffness="${stiffness}" damping="${spring ? chain.damping[i] : 0}" springlength="0">
  ${i < n ? `<joint joint="j${i}" coef="1"/>` : ""}${i > 0 ? `<joint joint="j${i - 1}" coef="-1"/>` : ""}</fixed>`);

const { default: load } = await import(createRequire(`${process.cwd()}/`).resolve("mujoco-js"));
const mujoco = await load();
mujoco.FS.writeFile("/chain.xml", `<mujoco><option integrator="${integrator}" gravity="0 0 0"/>
  <worldbody>${bodies.join("")}</worldbody><tendon>${tendons.join("")}</tendon></mujoco>`);
const model = mujoco.MjModel.loadFromXML("/chain.xml");
const data = new mujoco.MjData(model);

for await (const line of createInterface({ input: process.stdin })) {
  const { h, x, v } = JSON.parse(line);
  model.opt.timestep = h;
  data.qpos.set(x);
  data.qvel.set(v);
  mujoco.mj_step(model, data);
  console.log(JSON.stringify({ x: [...data.qpos], v: [...data.qvel] }));
}
