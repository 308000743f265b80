// Debian's three.js (r111, of 2019) with the names, colours and lights of today's, as far as src/ uses them: what `import "three"` means there.
/*! three.js r111, copyright 2010-2019 three.js authors, MIT licence */
import { Color, Matrix4, WebGLRenderer as Renderer } from "/usr/share/javascript/three/build/three.module.js";

export * from "/usr/share/javascript/three/build/three.module.js";
export {
  BoxBufferGeometry as BoxGeometry,
  ConeBufferGeometry as ConeGeometry,
  CylinderBufferGeometry as CylinderGeometry,
  LatheBufferGeometry as LatheGeometry,
  PlaneBufferGeometry as PlaneGeometry,
  SphereBufferGeometry as SphereGeometry,
} from "/usr/share/javascript/three/build/three.module.js";

// today light is added up linearly, and in physical units
const gamma = 2.2;
const setHex = Color.prototype.setHex;
Color.prototype.setHex = function (hex) {
  return setHex.call(this, hex).convertGammaToLinear(gamma);
};
export class WebGLRenderer extends Renderer {
  constructor(options) {
    super(options);
    Object.assign(this, { gammaOutput: true, gammaFactor: gamma, physicallyCorrectLights: true });
  }
}

Matrix4.prototype.invert = function () {
  return this.getInverse(this);
};
