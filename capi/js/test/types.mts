// Compiled by TypeScript (tests/release/browser.sh); nothing runs it.
import {load, DynError, type ContactForce, type Model} from "./libdyn.js";

export async function torque(text: string): Promise<number> {
  const dyn = await load();
  const model: Model = dyn.model(text, {base: dyn.Base.FLOATING, gravity: [0, 0, -9.81]}), data = model.data();
  const tau = new Float64Array(model.nv);
  try {
    dyn.c.dyn_rnea(model, data, data.q, data.v, data.v, null, tau);
    // @ts-expect-error: a value is missing
    dyn.c.dyn_rnea(model, data, data.q);
  } catch (error) {
    if (error instanceof DynError) console.log(error.status);
  }
  data.set_step_options({dt: 1e-3, integrator: dyn.Integrator.RK4});
  // @ts-expect-error: there is no such member
  data.set_step_options({step: 1e-3});
  const contacts: ContactForce[] = data.contacts();
  return tau[0] + contacts.length;
}
